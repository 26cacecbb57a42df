#pragma once
#include <mrpt/obs/CObservation.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libperception/detectors/ImageDetector.h"
#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// The images of a log brought down to the resolutions of [radecki2016], and a detector's boxes in
/// them. A panorama takes the size of the row; another camera as many pixels a radian as that has.
class ResolutionImages {
 public:
  /// `detector`: INI of perception-detect; `label` of the images, empty: of all. Throws
  /// ConfigError.
  ResolutionImages(const std::string& log, const std::string& label, const std::string& detector);

  bool isOurs(const mrpt::obs::CObservation& observation) const;
  /// The pixels; empty (and counted) when they are missing. Throws DataError for an image that is
  /// neither a panorama nor calibrated.
  std::optional<Raster> load(const mrpt::obs::CObservation& observation);
  /// Those resolutions of which the last loaded image has the pixels.
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
