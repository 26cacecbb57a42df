#include "libperception/app/ReportApp.h"

int main(int argc, char** argv) {
  perception::ReportApp app;
  return perception::runApp(app, argc, argv);
}
