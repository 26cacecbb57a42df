#pragma once
#include <vector>

#include "libperception/core/math/Random.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception::test {

/// An upright box on the ground; all in the ego frame.
struct SolidBox {
  Vector2 center = Vector2::Zero();  ///< [m]
  double yaw = 0;                    ///< [rad] of its length
  double length = 1, width = 1;      ///< [m]
  double bottom = 0, top = 1;        ///< [m]
};

/// An upright cylinder; ego frame.
struct SolidCylinder {
  Vector2 center = Vector2::Zero();  ///< [m]
  double radius = 0.25;              ///< [m]
  double bottom = 0, top = 1.7;      ///< [m]
};

struct SolidScene {
  GroundPlane ground;
  std::vector<SolidBox> boxes;
  std::vector<SolidCylinder> cylinders;
};

/// A spinning scanner like the HDL-64E: beams at even elevations.
struct SpinningLidar {
  Pose3 T_ego_sensor = makePose(0, 0, 1.73, 0);
  int beams = 64;
  double lowest = radians(-24.8), highest = radians(2);  ///< [rad]
  double azimuth_step = radians(0.25);                   ///< [rad]
  double fov = kTwoPi;                                   ///< [rad] about its forward axis
  double range_max = 80;                                 ///< [m]
  double range_sigma = 0.01;                             ///< [m]
};

/// [m] along a ray of direction `d` from `o` to the box; infinite where it is missed.
double rangeToBox(const SolidBox& box, const Vector3& o, const Vector3& d);

/// The scan of that scene (simulated): the nearest hit of every beam, with Gaussian range noise.
SensorFrame castScan(const SolidScene& scene, const SpinningLidar& lidar, Stamp stamp = {},
                     std::uint64_t seed = 1);

}  // namespace perception::test
