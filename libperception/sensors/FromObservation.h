#pragma once
#include <mrpt/obs/CObservation.h>

#include <cstdint>
#include <optional>
#include <string>

#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// What was dropped while an observation was decoded.
struct DecodeCounts {
  std::uint64_t points = 0;      ///< in the observation
  std::uint64_t not_finite = 0;  ///< points with NaN or Inf
  std::uint64_t no_range =
      0;  ///< points at the sensor itself: range 0, or negative in a range image
  std::uint64_t beyond_range = 0;  ///< farther than the instrument can see
  std::uint64_t bad_boxes =
      0;  ///< detections with a size or place that is not a number or not positive
  std::uint64_t bad_returns = 0;      ///< of radars: with a value that is not a number, or no range
  std::uint64_t missing_images = 0;   ///< whose file beside the log is not there
  std::uint64_t rejected_stamps = 0;  ///< observations without a usable stamp
  std::uint64_t rejected = 0;  ///< observations whose arrays contradict each other, or of a scanner
                               ///< whose calibration nobody knows

  std::uint64_t dropped() const {
    return not_finite + no_range + beyond_range + bad_boxes + bad_returns;
  }
};

/// The observation as a frame of one sensor: data, pose of the sensor on the vehicle, stamp, label.
/// The vehicle's pose and the frame number are left at their defaults. Empty when the class holds
/// nothing that a front end reads, or when the stamp is unusable. `counts`, when given, is added
/// to. `images`: folder of images stored outside of the log (imagesBeside() in CameraImages.h); an
/// image is read only when its load() is called.
///
/// Read are our own classes and of MRPT's: point clouds, Velodyne packets, planar scans, range
/// images, rotating scans and images.
std::optional<SensorFrame> frameFromObservation(const mrpt::obs::CObservation& observation,
                                                DecodeCounts* counts = nullptr,
                                                const std::string& images = "");

/// True for classes that frameFromObservation() decodes.
bool isSensorData(const mrpt::obs::CObservation& observation);
/// True for images: most front ends do not read them.
bool isImage(const mrpt::obs::CObservation& observation);

/// The number of the frame that starts with this observation: a CObservationComment with the text
/// "frame N".
std::optional<std::int64_t> frameNumber(const mrpt::obs::CObservation& observation);

/// Drops the points that no front end may see (see DecodeCounts); the order of the rest stays.
void dropBadPoints(LidarCloud& cloud, DecodeCounts& counts);

}  // namespace perception
