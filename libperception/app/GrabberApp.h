#pragma once
#include <string>

#include "libperception/app/App.h"

namespace perception {

/// perception-grabber: records the sensors of an INI of rawlog-grabber, every packet accounted for.
class GrabberApp : public App {
 public:
  double duration = 0;  ///< --duration [s]; 0: until SIGINT or SIGTERM
  std::string stream;   ///< --stream: pipe or file for observations as they come
  std::string publish;  ///< --publish INTERFACE[:DOMAIN] of DDS
  bool plugin = false;  ///< --plugin: print the path of MRPT's plugin and stop
  bool list = false;    ///< --list: say what a ROS 2 graph has and stop

  std::string name() const override { return "perception-grabber"; }
  std::string description() const override;
  void declare(CLI::App& cli) override;
  void run() override;

 private:
  void printGraph() const;
};

}  // namespace perception
