#include "libperception/app/Supervisor.h"
#include "studies/StudyApp.h"

int main(int argc, char** argv) {
  perception::StudyApp app;
  return perception::runSupervised(app, argc, argv);
}
