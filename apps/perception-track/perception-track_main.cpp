#include "libperception/app/TrackApp.h"

int main(int argc, char** argv) {
  perception::TrackApp app;
  return perception::runApp(app, argc, argv);
}
