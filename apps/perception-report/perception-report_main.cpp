#include "libperception/app/ReportApp.h"
#include "libperception/app/Supervisor.h"

int main(int argc, char** argv) {
  perception::ReportApp app;
  return perception::runSupervised(app, argc, argv);
}
