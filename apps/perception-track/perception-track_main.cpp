#include "libperception/app/Supervisor.h"
#include "libperception/app/TrackApp.h"

int main(int argc, char** argv) {
  perception::TrackApp app;
  return perception::runSupervised(app, argc, argv);
}
