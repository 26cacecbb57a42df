#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/sensors/CEgoFilter.h"
#include "libperception/sensors/EgoReadings.h"
#include "libperception/sensors/GnssFix.h"

namespace perception {

/// Noise of the vehicle's own sensors and how its pose is found without poses in the log: in [ego].
/// Figures of MEMS data sheets and usual wheels, assumed (method.md 1.4).
struct FusionParams {
  GnssParams gnss;
  std::string gnss_label, imu_label, wheels_label;  ///< empty: all of that kind
  double gyro_noise = radians(0.05);       ///< [rad/sqrt(s)] angle random walk (MEMS data sheets)
  double gyro_bias_sigma = radians(0.5);   ///< [rad/s] at the start
  double gyro_bias_walk = radians(0.002);  ///< [rad/s/sqrt(s)]
  double accel_noise = 0.05;               ///< [m/s^2 sqrt(s)] velocity random walk
  double accel_bias_sigma = 0.1;           ///< [m/s^2] at the start
  double accel_bias_walk = 0.002;          ///< [m/s^2/sqrt(s)]
  double wheel_sigma = 0.05;               ///< [m/s] of one reading
  double wheel_scale_sigma = 0.02;         ///< [-] tyres, pressure
  double slip = 0.02;          ///< [m/sqrt(s)] motion that neither wheels nor model explain
  double level_sigma = 0.3;    ///< [m/s^2] sideways force beside turning and gravity
  double heading_wait = 5;     ///< [s] for a heading before the start's frame is kept
  double late = 1;             ///< [s] at most an observation may come late
  std::vector<double> origin;  ///< [deg, deg, m] of the world; empty: the first fix

  void visit(ParamVisitor& v);
};

/// All that the estimate depends on: a value, so that the filter can go back to it.
struct EgoMotionState {
  /// A fix while the heading is not known, and where the vehicle thought to be then.
  struct Reference {
    Stamp stamp;
    Vector3 enu;      ///< [m]
    Vector2 place;    ///< [m] frame of the start
    double yaw;       ///< [rad] frame of the start
    Vector3 antenna;  ///< [m] on the vehicle
    double sigma;     ///< [m]
  };

  bool started = false;
  Stamp first, stamp;
  EgoEstimate estimate;
  std::optional<std::pair<Stamp, ImuReading>> imu;
  std::optional<std::pair<Stamp, WheelReading>> wheels;
  bool had_wheels = false;
  /// Of inertial readings since gravity was last looked at.
  struct {
    std::optional<Stamp> begin;
    int count = 0;
    Vector3 force = Vector3::Zero();  ///< [m/s^2] sum
    double turning = 0;               ///< [rad/s] sum of yaw rates as measured
  } level;
  bool heading_known = false;
  std::optional<Reference> reference, last_fix;
  std::optional<Geodetic> origin;           ///< of east, north, up
  double world_turn = 0;                    ///< [rad] of the world's x axis from east
  Vector3 world_shift = Vector3::Zero();    ///< [m] origin of the world in east, north, up
  Pose3 T_world_start = Pose3::Identity();  ///< where the frame of the start came to lie
  std::uint64_t relocations = 0, fixes = 0, rejected_fixes = 0;
  int rejected_in_row = 0, rejected_heights_in_row = 0;

  Vector3 toWorld(const Vector3& enu) const;
};

/// How readings change the state: the models around CEgoFilter.
class EgoMotion {
 public:
  explicit EgoMotion(FusionParams params) : params_(std::move(params)) {}

  EgoMotionState after(const EgoMotionState& before, Stamp stamp, const EgoReading& reading);
  /// [rad/s] of the vehicle at the state's instant.
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
  bool updatePlace(State& state, const GnssFix& fix, const Vector3& world);
  void updateVelocity(State& state, const GnssFix& fix);
  void updateYaw(State& state, double yaw, double sigma);
  void findHeading(State& state, const GnssFix& fix, const Vector3& enu) const;
  void setHeading(State& state, const GnssFix& fix, const Vector3& enu, double turn,
                  double sigma) const;

  FusionParams params_;
  CEgoFilter filter_;
};

}  // namespace perception
