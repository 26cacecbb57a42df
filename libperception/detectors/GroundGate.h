#pragma once
#include <optional>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Constraint on image boxes by the ground plane and the height of the objects (method.md 8.8): a
/// box of p pixels whose lower edge sees the ground at slope q is p h / (f q) meters high, with
/// camera height h and focal length f.
struct GroundGate {
  double horizon = 0;         ///< [px] row of the horizon, at the middle column
  double focal = 0;           ///< [px]
  double height = 0;          ///< [m] of the camera over the ground
  double slope_sigma = 0.02;  ///< [rad] standard deviation of pitch and slope of the ground

  /// Whether a box with these rows [px] may be an object `low` to `high` meters high.
  bool admits(double top, double bottom, double low, double high) const;
  /// Rows of lower edges [px] at which a box of `pixels` may stand.
  struct Rows {
    double begin = 0, end = 0;
  };
  Rows bottoms(double pixels, double low, double high) const;
};

/// Empty for a camera that is on or below the ground, or for one that looks up or down by more than
/// 45 degrees.
std::optional<GroundGate> groundGate(const CameraModel& camera, const Pose3& T_ego_camera,
                                     const GroundPlane& ground, double slope_sigma);

/// The region of an image in which objects are searched.
struct SearchRegion {
  std::optional<GroundGate> ground;  ///< empty: the whole image
  /// Other images adjoin at both sides (tiles of a panorama) and show truncated objects whole.
  bool continued = false;
};

}  // namespace perception
