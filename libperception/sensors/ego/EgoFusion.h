#pragma once
#include <mrpt/obs/CObservation.h>

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/sensors/ego/EgoMotion.h"

namespace perception {

/// The vehicle's pose, attitude and speed from GNSS fixes, gyros, accelerometer and wheels, as far
/// as available, by one extended Kalman filter (CEgoFilter, method.md 1.4).
///
/// The vehicle starts at the origin of its start frame, x ahead. The heading comes from two
/// antennas, the receiver's INS or course, or the path driven. When it is found within
/// heading_wait, the world frame becomes east, north, up about the first fix (or `origin`) and
/// earlier poses are transformed into it, counted by state().relocations. When it is found later or
/// never, the world frame remains the start frame, and fixes are transformed into that.
///
/// Observations may come late and out of order: the result is that of the sorted log.
class EgoFusion {
 public:
  explicit EgoFusion(FusionParams params);

  /// Takes CObservationGPS, CObservationIMU and CObservationOdometry; others are ignored. True when
  /// the estimate has changed.
  bool add(const mrpt::obs::CObservation& observation);
  /// Resets, as after a jump of the clock.
  void clear();

  /// Poses of the last 10 s by stamp, one per observation, with the filter's standard deviations.
  const std::deque<EgoState>& poses() const { return poses_; }
  /// The latest state.
  const EgoMotionState& state() const { return steps_.back().state; }

  std::uint64_t late() const { return late_; }          ///< dropped: later than [ego] late
  std::uint64_t unusable() const { return unusable_; }  ///< invalid stamp or values, no fix

 private:
  /// A reading and the state after it.
  struct Step {
    Stamp stamp;
    std::string label;
    EgoReading reading;
    EgoMotionState state;
  };
  static bool before(const Step& a, const Step& b);
  std::optional<EgoReading> readingOf(const mrpt::obs::CObservation& observation);
  void publish(const EgoMotionState& state);

  EgoMotion motion_;
  Odometers odometers_;
  std::deque<Step> steps_;  ///< of the last `late` seconds, by time; the first one is the base
  std::deque<EgoState> poses_;
  Pose3 T_world_start_ = Pose3::Identity();  ///< applied to the poses before the heading was known
  std::uint64_t late_ = 0, unusable_ = 0;
};

}  // namespace perception
