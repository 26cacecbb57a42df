#pragma once
#include <mrpt/obs/CObservation.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libperception/detectors/ImageDetector.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Runs a detector on the images of a log scaled down to the resolutions of [radecki2016]: a
/// panorama to the size of the row, other cameras to the same pixels per radian.
class ResolutionImages {
 public:
  /// `detector`: INI of perception-detect; `label` of the images, empty: of all. Throws
  /// ConfigError.
  ResolutionImages(const std::string& log, const std::string& label, const std::string& detector);

  bool isOurs(const mrpt::obs::CObservation& observation) const;
  /// Loads the pixels; empty (and counted) if missing. Throws DataError for an image that is
  /// neither a panorama nor calibrated.
  std::optional<Raster> load(const mrpt::obs::CObservation& observation);
  /// The resolutions that the last loaded image has.
  std::vector<int> resolutions() const;
  /// Boxes of the last loaded image at a resolution, scores as log-odds, under a label.
  std::shared_ptr<mrpt::obs::CObservation> boxes(const Raster& image, int resolution,
                                                 const std::string& label);

  int missing() const { return missing_; }
  const std::map<int, double>& seconds() const { return seconds_; }  ///< wall, by resolution

 private:
  double scaleTo(int resolution) const;

  std::string log_, label_, folder_;
  std::unique_ptr<ImageDetector> detector_;
  std::optional<SensorFrame> frame_;
  CameraModel camera_;
  int missing_ = 0;
  std::map<int, double> seconds_;
};

}  // namespace perception
