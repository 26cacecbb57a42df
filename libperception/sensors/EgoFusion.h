#pragma once
#include <mrpt/obs/CObservation.h>

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "libperception/measurement/SensorFrame.h"
#include "libperception/sensors/EgoMotion.h"

namespace perception {

/// The vehicle's pose, attitude and speed from satellite fixes, gyros, accelerometer and wheels, as
/// far as a log has them, by one extended Kalman filter (CEgoFilter).
///
/// Until the heading is known the vehicle starts at the origin of its own frame, x ahead. The
/// heading comes from two antennas, the receiver's INS or course, or from the way driven. Found
/// within heading_wait, the world is east, north, up about the first fix (or `origin`) and what was
/// said before is turned into it: state().relocations counts that. Found later, or never, the world
/// remains the frame of the start, and fixes are turned into that.
///
/// Observations may come late and in any order: the result is that of the sorted log.
class EgoFusion {
 public:
  explicit EgoFusion(FusionParams params);

  /// Takes CObservationGPS, CObservationIMU and CObservationOdometry; others are ignored. True when
  /// the estimate has changed.
  bool add(const mrpt::obs::CObservation& observation);
  /// Forgets everything, as after a jump of the clock.
  void clear();

  /// By stamp, one an observation, with the filter's own uncertainties. Those of the last `history`
  /// seconds.
  const std::deque<EgoState>& poses() const { return poses_; }
  /// Newest state.
  const EgoMotionState& state() const { return steps_.back().state; }

  std::uint64_t late() const { return late_; }          ///< dropped: later than [ego] late
  std::uint64_t unusable() const { return unusable_; }  ///< bad stamp or numbers, no fix

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
