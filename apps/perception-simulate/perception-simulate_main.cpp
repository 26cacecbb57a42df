#include "libperception/app/SimulateApp.h"
#include "libperception/app/Supervisor.h"

int main(int argc, char** argv) {
  perception::SimulateApp app;
  return perception::runSupervised(app, argc, argv);
}
