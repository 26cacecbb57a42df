#include "libperception/app/DetectApp.h"

int main(int argc, char** argv) {
  perception::DetectApp app;
  return perception::runApp(app, argc, argv);
}
