#include "libperception/app/CalibrateApp.h"
#include "libperception/app/Supervisor.h"

int main(int argc, char** argv) {
  perception::CalibrateApp app;
  return perception::runSupervised(app, argc, argv);
}
