#pragma once
#include <string>
#include <vector>

#include "libperception/core/Frames.h"

namespace perception {

/// Planar motion state at one instant, world frame.
struct Motion2 {
  Vector2 position = Vector2::Zero();  ///< [m]
  Vector2 velocity = Vector2::Zero();  ///< [m/s] exact derivative of the position
  double heading =
      0;  ///< [rad] of the velocity; at rest the last (before any motion the first) one
  double yaw_rate = 0;  ///< [rad/s] 0 at rest
  double traveled = 0;  ///< [m] distance since the first waypoint
};

/// A smooth path through timed waypoints. Each coordinate is a monotone cubic of time
/// [fritsch1984], so there is no overshoot: two waypoints at one position are a pause, and
/// collinear waypoints give a straight path. At rest before the first and after the last waypoint.
class Trajectory {
 public:
  /// `heading` [rad]: if it never moves. Precondition: fault() of the lists is empty.
  Trajectory(std::vector<double> t, std::vector<double> x, std::vector<double> y, double heading);

  /// Error message for invalid lists; empty if valid.
  static std::string fault(const std::vector<double>& t, const std::vector<double>& x,
                           const std::vector<double>& y);

  Motion2 at(double t) const;  ///< t [s]
  double duration() const { return t_.back() - t_.front(); }

 private:
  /// Position and its first two derivatives of one coordinate.
  struct Cubic {
    double value, first, second;
  };
  Cubic evaluate(const std::vector<double>& values, const std::vector<double>& slopes,
                 double t) const;
  void tabulate(double heading);

  std::vector<double> t_, x_, y_;           ///< [s, m, m] waypoints
  std::vector<double> slope_x_, slope_y_;   ///< [m/s] at the waypoints
  std::vector<double> heading_, traveled_;  ///< [rad, m] every kTableStep from t_.front()
};

}  // namespace perception
