#pragma once
#include <mrpt/obs/CObservation.h>

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libperception/app/App.h"
#include "libperception/app/detect/DetectImages.h"
#include "libperception/app/detect/DetectLabels.h"
#include "libperception/detectors/DetectionQuality.h"
#include "libperception/detectors/ImageDetector.h"

namespace perception {

class OutputFolder;

/// perception-detect: a camera detector on images, or on the images of a log.
class DetectApp : public App {
 public:
  std::string labels;        ///< --labels: truth of images
  std::string calibrations;  ///< --calib: folder of KITTI calibrations
  std::string camera_label;  ///< --camera: sensorLabel of the log's images; empty: all
  std::string
      boxes_label;        ///< --label: sensorLabel of the boxes; empty: that of the images + _BOXES
  std::string calibrate;  ///< --calibrate: output INI of the fitted logistic functions
  std::string kitti_folder;  ///< --export kitti:DIR
  std::string
      train_heading;  ///< --train-heading: output file of the heading head trained on the labels
  std::string heading_label = "Car";  ///< --heading-label: label of the training boxes
  bool pictures = false;              ///< --pictures
  int every = 1;                      ///< --every: uses every n-th image of the log
  double overlap = 0.5, min_height = 25, max_truncation = 0.3;
  int max_occlusion = 1;

  std::int64_t out_images = 0, out_objects = 0, out_unreadable = 0;
  std::vector<LabelQuality> out_quality;
  double out_seconds = 0;  ///< wall time of detection

  std::string name() const override { return "perception-detect"; }
  std::string description() const override;
  void declare(CLI::App& cli) override;
  void run() override;

 private:
  /// An image with its boxes, for the outputs.
  struct Result {
    std::string name;
    Raster image;
    ObjectDetections found;
    std::vector<double> raw;  ///< scores before calibration
    std::vector<LabeledBox> truth;
  };
  void runImages(const ImageDetector& detector, const DetectCameraParams& camera);
  struct LogOutput;
  void openOutput(bool detects, LogOutput& out) const;
  void closeOutput(const std::string& images, LogOutput& out) const;
  void runLog(const ImageDetector& detector, const DetectCameraParams& camera,
              const std::string& log);
  /// Detections in an image of a log; empty if it cannot be read.
  std::optional<Result> detectIn(const SensorFrame& frame, std::int64_t number,
                                 const ImageDetector& detector, const DetectCameraParams& params);
  std::shared_ptr<mrpt::obs::CObservation> boxesObservation(const SensorFrame& image,
                                                            const ObjectDetections& found) const;
  void draw(OutputFolder& folder, const Result& result) const;
  ObjectDetections timed(const ImageDetector& detector, const Raster& image,
                         const CameraModel& camera, const std::optional<Pose3>& pose);
  void finish(const ImageDetector& detector, Result& result);
  void trainHeading() const;
  void writeResults(OutputFolder* folder) const;
  void report() const;

  DetectionQuality quality_{0.5, 25};
  std::string rows_;  ///< detections.csv
  bool scores_are_log_odds_ = false;
};

}  // namespace perception
