#pragma once
#include <optional>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/core/math/Angle.h"
#include "libperception/core/math/Random.h"

/// An oncoming or crossing car that stops and continues; half of them turn.
namespace perception::heading_scene {

inline constexpr double kStep = 0.1;                   ///< [s]
inline constexpr double kBearingSigma = radians(1.5);  ///< [rad] camera
inline constexpr double kAxisSigma = radians(8);       ///< [rad] camera

/// The car at an instant; the sensors are at the origin, facing along x.
struct CarState {
  Vector2 p;                  ///< [m]
  double v = 0, heading = 0;  ///< [m/s], [rad]
};

/// Path of the car, one state per step.
std::vector<CarState> drive(Rng& rng);

/// Measurements of the car at one instant.
struct Seen {
  bool in_view = false;
  std::optional<Vector3> camera;  ///< bearing [rad], range [m], heading [rad]
  std::optional<Vector3> radar;   ///< range [m], bearing [rad], range rate [m/s]
};

/// `flip`: share of reversed headings.
std::vector<Seen> sense(const std::vector<CarState>& path, bool radar, double flip, Rng& rng);

}  // namespace perception::heading_scene
