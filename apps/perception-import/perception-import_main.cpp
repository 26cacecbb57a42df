#include "libperception/app/ImportApp.h"
#include "libperception/app/Supervisor.h"

int main(int argc, char** argv) {
  perception::ImportApp app;
  return perception::runSupervised(app, argc, argv);
}
