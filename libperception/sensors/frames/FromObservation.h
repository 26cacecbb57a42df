#pragma once
#include <mrpt/obs/CObservation.h>

#include <cstdint>
#include <optional>
#include <string>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Counts of points and objects that were dropped while decoding.
struct DecodeCounts {
  std::uint64_t points = 0;        ///< in the observation
  std::uint64_t not_finite = 0;    ///< points with NaN or Inf
  std::uint64_t no_range = 0;      ///< points without range: 0, or negative in a range image
  std::uint64_t beyond_range = 0;  ///< beyond the maximum range of the instrument
  std::uint64_t bad_boxes =
      0;  ///< detections with a size that is not positive or values that are not finite
  std::uint64_t bad_returns = 0;  ///< of radars: with a value that is not finite, or without range
  std::uint64_t missing_images = 0;   ///< external images without a file
  std::uint64_t rejected_stamps = 0;  ///< observations without a usable stamp
  std::uint64_t rejected = 0;         ///< inconsistent arrays, unknown calibration of a scanner

  std::uint64_t dropped() const {
    return not_finite + no_range + beyond_range + bad_boxes + bad_returns;
  }
};

/// Decodes an observation into a sensor frame: data, T_ego_sensor, stamp, label. Ego state and
/// frame number keep their defaults. Empty for classes that no front end reads and for unusable
/// stamps. Adds to `counts`, unless null. `images`: folder of external images (imagesBeside() in
/// CameraImages.h); an image is read when its load() is called.
///
/// Supported are this library's classes and of MRPT's: point clouds, Velodyne packets, planar
/// scans, range images, rotating scans and images.
std::optional<SensorFrame> frameFromObservation(const mrpt::obs::CObservation& observation,
                                                DecodeCounts* counts = nullptr,
                                                const std::string& images = "");

/// The same of an observation that is not needed any more: a lidar scan's points are moved.
std::optional<SensorFrame> frameFromObservation(mrpt::obs::CObservation&& observation,
                                                DecodeCounts& counts);

/// True for classes that frameFromObservation() decodes.
bool isSensorData(const mrpt::obs::CObservation& observation);
/// True for images, which most front ends do not read.
bool isImage(const mrpt::obs::CObservation& observation);

/// The number of the frame that starts with this observation: a CObservationComment with the text
/// "frame N".
std::optional<std::int64_t> frameNumber(const mrpt::obs::CObservation& observation);

/// Removes invalid points (see DecodeCounts); keeps the order of the rest.
void dropBadPoints(LidarCloud& cloud, DecodeCounts& counts);

}  // namespace perception
