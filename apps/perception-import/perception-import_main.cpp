#include "libperception/app/ImportApp.h"

int main(int argc, char** argv) {
  perception::ImportApp app;
  return perception::runApp(app, argc, argv);
}
