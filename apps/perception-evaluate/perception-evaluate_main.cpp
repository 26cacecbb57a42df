#include "libperception/app/EvaluateApp.h"
#include "libperception/app/Supervisor.h"

int main(int argc, char** argv) {
  perception::EvaluateApp app;
  return perception::runSupervised(app, argc, argv);
}
