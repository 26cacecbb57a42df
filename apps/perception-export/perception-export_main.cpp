#include "libperception/app/ExportApp.h"
#include "libperception/app/Supervisor.h"

int main(int argc, char** argv) {
  perception::ExportApp app;
  return perception::runSupervised(app, argc, argv);
}
