#include "studies/StudyApp.h"

int main(int argc, char** argv) {
  perception::StudyApp app;
  return perception::runApp(app, argc, argv);
}
