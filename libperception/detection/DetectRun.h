#pragma once
#include <mrpt/obs/CObservation.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libperception/detection/DetectImages.h"
#include "libperception/detection/DetectLabels.h"
#include "libperception/detectors/DetectionQuality.h"
#include "libperception/detectors/ImageDetector.h"

namespace perception {

class OutputFolder;

/// What a run of a detector over images takes and writes.
struct DetectOptions {
  std::string output;        ///< folder, or FILE.rawlog of a log; empty: none
  std::string labels;        ///< truth of images
  std::string calibrations;  ///< folder of KITTI calibrations
  std::string camera_label;  ///< sensorLabel of the log's images; empty: all
  std::string boxes_label;   ///< sensorLabel of the boxes; empty: that of the images + _BOXES
  std::string kitti_folder;  ///< one file per image in KITTI's layout; empty: none
  bool pictures = false;     ///< drawn into the folder
  bool strict = false;       ///< damaged input is an error instead of a warning
  int every = 1;             ///< uses every n-th image of a log
  double overlap = 0.5;      ///< least intersection over union of a right box
  LabelRules rules;
};

struct DetectTotals {
  std::int64_t images = 0, objects = 0, unreadable = 0;
  std::vector<LabelQuality> quality;
  double seconds = 0;  ///< wall time of detection
};

/// A camera detector on images, or on the images of a log; use it once.
class DetectRun {
 public:
  /// `warn` is told of what cannot be read.
  DetectRun(const ImageDetector& detector, DetectCameraParams camera, DetectOptions options,
            std::function<void(const std::string&)> warn);

  /// Files and folders of images. Throws Error (kUsage), DataError, OutputError.
  void readImages(const std::vector<std::string>& inputs);
  /// The same of a log.
  void readLog(const std::string& log);
  const DetectTotals& totals() const { return totals_; }
  /// The fitted logistic functions as an INI.
  std::string calibration() const;

 private:
  /// An image with its boxes, for the outputs.
  struct Result {
    std::string name;
    Raster image;
    ObjectDetections found;
    std::vector<double> raw;  ///< scores before calibration
    std::vector<LabeledBox> truth;
  };
  struct LogOutput;
  void openOutput(LogOutput& out) const;
  void closeOutput(const std::string& images, LogOutput& out) const;
  std::shared_ptr<mrpt::obs::CObservation> boxesObservation(const SensorFrame& image,
                                                            const ObjectDetections& found) const;
  /// Detections in an image of a log; empty if it cannot be read.
  std::optional<Result> detectIn(const SensorFrame& frame, std::int64_t number);
  void draw(OutputFolder& folder, const Result& result) const;
  ObjectDetections timed(const Raster& image, const CameraModel& camera,
                         const std::optional<Pose3>& pose);
  void finish(Result& result);
  void writeResults(OutputFolder& folder) const;

  const ImageDetector& detector_;
  DetectCameraParams camera_;
  DetectOptions options_;
  std::function<void(const std::string&)> warn_;
  DetectTotals totals_;
  DetectionQuality quality_;
  std::string rows_ = "image,label,score,probability,x1,y1,x2,y2,heading_deg\n";
  bool scores_are_log_odds_ = false;
};

}  // namespace perception
