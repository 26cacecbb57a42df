#pragma once
#include <optional>

#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// Where in an image things of a known height can stand: the ground as one camera sees it. A box of
/// p pixels whose lower edge looks down on the ground at slope q is p h / (f q) meters high.
struct GroundGate {
  double horizon = 0;         ///< [px] row of the horizon, at the middle column
  double focal = 0;           ///< [px]
  double height = 0;          ///< [m] of the camera over the ground
  double slope_sigma = 0.02;  ///< [rad] how far pitch and slope of the ground may be off

  /// May a box with these rows [px] be an object between `low` and `high` meters?
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

/// Where in an image objects are looked for.
struct SearchRegion {
  std::optional<GroundGate> ground;  ///< without it everywhere
  /// Other images go on at both sides (tiles of a panorama): what this one cuts is theirs.
  bool continued = false;
};

}  // namespace perception
