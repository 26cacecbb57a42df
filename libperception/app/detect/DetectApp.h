#pragma once
#include <string>

#include "libperception/app/App.h"
#include "libperception/detection/DetectRun.h"

namespace perception {

/// perception-detect: a camera detector on images, or on the images of a log.
class DetectApp : public App {
 public:
  DetectApp()
      : App("perception-detect",
            "Finds cars and people in images, or in the images of a log; compares with labels.") {}

  DetectOptions options;
  std::string calibrate;     ///< --calibrate: output INI of the fitted logistic functions
  std::string kitti_export;  ///< --export kitti:DIR

  DetectTotals out;

  void declare(CLI::App& cli) override;
  void run() override;
};

}  // namespace perception
