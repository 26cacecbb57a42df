#pragma once
#include <utility>

#include "libperception/sensors/ego/CEgoFilter.h"
#include "libperception/sensors/ego/EgoMotionState.h"
#include "libperception/sensors/ego/EgoReadings.h"
#include "libperception/sensors/ego/FusionParams.h"
#include "libperception/sensors/satellites/GnssFix.h"

namespace perception {

/// Motion and observation models of the vehicle for CEgoFilter.
class EgoMotion {
 public:
  explicit EgoMotion(FusionParams params) : params_(std::move(params)) {}

  EgoMotionState after(const EgoMotionState& before, Stamp stamp, const EgoReading& reading);
  /// Yaw rate of the vehicle [rad/s] at the time of the state.
  double yawRate(const EgoMotionState& state) const;
  const FusionParams& params() const { return params_; }

 private:
  using State = EgoMotionState;
  void start(State& state, Stamp stamp) const;
  void advance(State& state, Stamp stamp);
  EgoInput inputAt(const State& state, Stamp stamp) const;
  void updateAttitude(State& state, const ImuReading& imu);
  bool isStationary(const State& state, Stamp stamp) const;
  void apply(State& state, const ImuReading& imu);
  void apply(State& state, const WheelReading& wheels);
  void apply(State& state, const GnssFix& fix);

  FusionParams params_;
  CEgoFilter filter_;
};

}  // namespace perception
