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
  std::string calibrate;      ///< --calibrate: output INI of the fitted logistic functions
  std::string kitti_export;   ///< --export kitti:DIR
  std::string train_heading;  ///< --train-heading: output file of the head trained on the labels
  std::string heading_label = "Car";  ///< --heading-label: label of the training boxes

  DetectTotals out;

  void declare(CLI::App& cli) override;
  void run() override;

 private:
  void trainHeading() const;
};

}  // namespace perception
