#include "libperception/app/Programs.h"
#include "libperception/app/Supervisor.h"

int main(int argc, char** argv) {
  return perception::runSupervised(*perception::exportApp(), argc, argv);
}
