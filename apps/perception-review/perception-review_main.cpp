#include "libperception/app/ReviewApp.h"
#include "libperception/app/Supervisor.h"

int main(int argc, char** argv) {
  perception::ReviewApp app;
  return perception::runSupervised(app, argc, argv);
}
