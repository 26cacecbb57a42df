#include "libperception/app/CalibrateApp.h"

int main(int argc, char** argv) {
  perception::CalibrateApp app;
  return perception::runApp(app, argc, argv);
}
