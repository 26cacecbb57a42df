#include "libperception/app/EvaluateApp.h"

int main(int argc, char** argv) {
  perception::EvaluateApp app;
  return perception::runApp(app, argc, argv);
}
