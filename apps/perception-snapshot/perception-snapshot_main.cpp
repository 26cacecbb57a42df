#include "libperception/app/SnapshotApp.h"
#include "libperception/app/Supervisor.h"

int main(int argc, char** argv) {
  perception::SnapshotApp app;
  return perception::runSupervised(app, argc, argv);
}
