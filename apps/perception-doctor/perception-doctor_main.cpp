#include "libperception/app/DoctorApp.h"
#include "libperception/app/Supervisor.h"

int main(int argc, char** argv) {
  perception::DoctorApp app;
  return perception::runSupervised(app, argc, argv);
}
