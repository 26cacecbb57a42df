#include "libperception/app/DetectApp.h"
#include "libperception/app/Supervisor.h"

int main(int argc, char** argv) {
  perception::DetectApp app;
  return perception::runSupervised(app, argc, argv);
}
