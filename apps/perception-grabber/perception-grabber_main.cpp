#include "libperception/app/GrabberApp.h"
#include "libperception/app/Supervisor.h"

int main(int argc, char** argv) {
  perception::GrabberApp app;
  return perception::runSupervised(app, argc, argv);
}
