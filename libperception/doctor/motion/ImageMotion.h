#pragma once
#include <memory>
#include <optional>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// How a camera moved between two images.
struct CameraMotion {
  Stamp from, to;
  Eigen::Matrix3d turn =
      Eigen::Matrix3d::Identity();  ///< takes directions of the second image's frame to the first's
  Vector3 travel = Vector3::UnitZ();  ///< unit vector of the way, optical frame of the first image
};

/// Motion of one camera over .3 s: corners followed from image to image by Lucas-Kanade, forth and
/// back; the essential matrix of most of them by MAGSAC++ (five points).
class ImageMotion {
 public:
  ImageMotion();
  ~ImageMotion();
  ImageMotion(ImageMotion&&) noexcept;
  /// Motion since the last image; empty for the first one, after more than .5 s, where nothing
  /// moves in the image, and without enough corners that agree. `image`: pinhole, with known focal
  /// length.
  std::optional<CameraMotion> update(const CameraModel& camera, const Raster& image, Stamp stamp);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace perception
