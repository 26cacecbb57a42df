#include "libperception/app/BatchApp.h"
#include "libperception/app/Supervisor.h"

int main(int argc, char** argv) {
  perception::BatchApp app;
  return perception::runSupervised(app, argc, argv);
}
