#include "libperception/app/SnapshotApp.h"

int main(int argc, char** argv) {
  perception::SnapshotApp app;
  return perception::runApp(app, argc, argv);
}
