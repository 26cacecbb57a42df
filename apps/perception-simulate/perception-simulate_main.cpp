#include "libperception/app/SimulateApp.h"

int main(int argc, char** argv) {
  perception::SimulateApp app;
  return perception::runApp(app, argc, argv);
}
