#include "libperception/simulation/recorded/RecordedScan.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libperception/simulation/lidar/LidarCaster.h"
#include "libperception/simulation/lidar/LidarEcho.h"

namespace perception {
namespace {

constexpr double kUnknownReflectivity = 0.2;  // a mean surface (assumed)
constexpr double kIncidence = 0.7;            // cosine, of what is no road (assumed)
constexpr std::uint32_t kMissingSlot = 1u << 28, kMarginPurpose = 0x400;
constexpr std::size_t kScanGrain = 2048;  // pulses a task

/// Which returns are of the road: within 0.2 m above the lowest one of a cell of 10 deg by 4 m, if
/// that is within 1 m of the plane on which the vehicle stands (assumed).
class RoadReturns {
 public:
  RoadReturns(const std::vector<Vector3>& places, const Vector3& sensor) : sensor_(sensor) {
    lowest_.assign(kSectors * kRings, std::numeric_limits<double>::infinity());
    for (const Vector3& p : places)
      if (p.z() > -kSlope) lowest_[cellOf(p)] = std::min(lowest_[cellOf(p)], p.z());
  }
  bool contains(const Vector3& p) const {
    const double low = lowest_[cellOf(p)];
    return low < kSlope && p.z() < low + kThick && p.z() > -kSlope;
  }

 private:
  static constexpr std::size_t kSectors = 36, kRings = 40;
  static constexpr double kSlope = 1, kThick = 0.2;  // [m]
  std::size_t cellOf(const Vector3& p) const {
    const Vector2 d = (p - sensor_).head<2>();
    const auto sector = static_cast<std::size_t>((std::atan2(d.y(), d.x()) + kPi) / kTwoPi *
                                                 static_cast<double>(kSectors));
    const auto ring = static_cast<std::size_t>(d.norm() / 4);
    return std::min(sector, kSectors - 1) * kRings + std::min(ring, kRings - 1);
  }
  Vector3 sensor_;
  std::vector<double> lowest_;  // [m]
};

/// One pulse and what comes back.
struct Shot {
  LidarPulse pulse;
  Vector3 aim;             // unit, sensor frame
  double clear = 0;        // reflectivity in clear air; of a pulse without a return 0
  std::uint32_t slot = 0;  // of its random numbers
  LidarEcho echo;
};

/// Step in which this recording reports intensities: its least one above 0, within 1/255 and 0.02.
double intensityStep(const LidarCloud& cloud) {
  constexpr float kLeast = 1.0F / 255, kMost = 0.02F;
  float step = kMost;
  for (const float intensity : cloud.intensity)
    if (intensity > 0) step = std::min(step, intensity);
  return static_cast<double>(std::max(step, kLeast));
}

template <class T>
void addIf(std::vector<T>& to, const std::vector<T>& from, std::size_t i) {
  if (!from.empty()) to.push_back(from[i]);
}

/// The pulses of a recorded scan: first those with a return.
class RecordedPulses {
 public:
  RecordedPulses(const LidarCloud& cloud, const std::vector<BeamPattern::Beam>& missing,
                 const LidarSensorParams& lidar, const Pose3& T_world_sensor, const RngKey& key)
      : cloud_(cloud),
        missing_(missing),
        T_world_sensor_(T_world_sensor),
        key_(key),
        least_(0.9 / (lidar.reference_range * lidar.reference_range)),
        step_(intensityStep(cloud)),
        places_(placesOf(cloud, T_world_sensor)),
        road_(places_, T_world_sensor.translation()) {}

  std::size_t size() const { return cloud_.size() + missing_.size(); }
  /// In clear air.
  Shot at(std::size_t i) const {
    Shot shot = i < cloud_.size() ? ofReturn(i) : ofMissing(missing_[i - cloud_.size()]);
    shot.pulse.origin = T_world_sensor_.translation();
    shot.pulse.azimuth = std::atan2(shot.aim.y(), shot.aim.x());
    shot.pulse.elevation = std::asin(std::clamp(shot.aim.z(), -1.0, 1.0));
    return shot;
  }
  /// What the instrument writes of pulse i.
  void append(std::size_t i, const Shot& shot, LidarCloud& out) const {
    const bool of_surface = shot.echo.of_surface && i < cloud_.size();
    if (of_surface && shot.echo.range == static_cast<double>(rangeOf(i))) {
      out.x.push_back(cloud_.x[i]), out.y.push_back(cloud_.y[i]), out.z.push_back(cloud_.z[i]);
    } else {
      const Vector3 p = shot.aim * shot.echo.range;
      out.x.push_back(static_cast<float>(p.x())), out.y.push_back(static_cast<float>(p.y()));
      out.z.push_back(static_cast<float>(p.z()));
    }
    if (!cloud_.intensity.empty()) {
      // What the unit called this surface, times what the weather leaves of it.
      out.intensity.push_back(
          of_surface ? cloud_.intensity[i] *
                           static_cast<float>(shot.echo.intensity / std::min(1.0, shot.clear))
                     : static_cast<float>(inSteps(shot.echo.intensity)));
    }
    // What a pulse without a return would have had is not known: as the last one with a return.
    const std::size_t like = std::min(i, cloud_.size() - 1);
    addIf(out.ring, cloud_.ring, like), addIf(out.time_offset, cloud_.time_offset, like);
    addIf(out.echo, cloud_.echo, like), addIf(out.pulse_width, cloud_.pulse_width, like);
    addIf(out.label, cloud_.label, like);
  }

 private:
  // As the instrument reports it: the faintest have 0.
  double inSteps(double intensity) const { return step_ * std::round(intensity / step_); }
  static std::vector<Vector3> placesOf(const LidarCloud& cloud, const Pose3& T_world_sensor) {
    std::vector<Vector3> places(cloud.size());
    for (std::size_t i = 0; i < places.size(); ++i)
      places[i] =
          T_world_sensor * Vector3(static_cast<double>(cloud.x[i]), static_cast<double>(cloud.y[i]),
                                   static_cast<double>(cloud.z[i]));
    return places;
  }
  float rangeOf(std::size_t i) const {
    constexpr double kLeast = 1e-3;  // [m] has a direction
    return static_cast<float>(
        std::max(kLeast, (places_[i] - T_world_sensor_.translation()).norm()));
  }

  Shot ofReturn(std::size_t i) const {
    Shot shot;
    LidarPulse& pulse = shot.pulse;
    const auto range = static_cast<double>(rangeOf(i));
    pulse.direction = (places_[i] - T_world_sensor_.translation()).normalized();
    shot.aim = T_world_sensor_.linear().transpose() * pulse.direction;
    shot.slot = static_cast<std::uint32_t>(i);
    const bool on_road = road_.contains(places_[i]);
    pulse.hit.range = rangeOf(i);
    pulse.hit.object = on_road ? BeamHit::kRoad : BeamHit::kRecorded;
    pulse.hit.material = on_road ? Material::kRoad : Material::kWall;
    pulse.hit.cos_incidence =
        static_cast<float>(on_road ? std::abs(pulse.direction.z()) : kIncidence);
    const double intensity =
        cloud_.intensity.empty() ? kUnknownReflectivity : static_cast<double>(cloud_.intensity[i]);
    // Of a return at the threshold it is not known by how much it exceeds that.
    Rng margin(key_.withSlot(shot.slot).withPurpose(key_.purpose ^ kMarginPurpose));
    pulse.reflectivity = shot.clear =
        std::max(intensity, least_ * range * range * margin.uniform(1.001, 2));
    return shot;
  }
  Shot ofMissing(const BeamPattern::Beam& beam) const {
    Shot shot;
    shot.aim = beam.direction, shot.slot = kMissingSlot + beam.slot;
    shot.pulse.direction = T_world_sensor_.linear() * shot.aim;
    return shot;
  }

  const LidarCloud& cloud_;
  const std::vector<BeamPattern::Beam>& missing_;
  Pose3 T_world_sensor_;
  RngKey key_;
  double least_;                 // P_min [1/m^2]
  double step_;                  // of intensities
  std::vector<Vector3> places_;  // [m] world
  RoadReturns road_;
};

}  // namespace

WeatheredScan throughWeather(const LidarCloud& cloud, const std::vector<BeamPattern::Beam>& missing,
                             const SimulatedWeather& weather, const SensorParams& sensor,
                             const Pose3& T_world_sensor, const LidarCaster& scene,
                             const RngKey& key) {
  const RecordedPulses pulses(cloud, missing, sensor.lidar, T_world_sensor, key);
  std::vector<Shot> shots(pulses.size());
  scene.parallel(shots.size(), kScanGrain, [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      Shot& shot = shots[i] = pulses.at(i);
      shot.pulse.scene = &scene;
      Rng rng(key.withSlot(shot.slot));
      weather.alter(sensor, shot.pulse, rng);
      shot.echo = echoOf(shot.pulse, shot.pulse.reflectivity, sensor.lidar);
      if (!shot.echo.of_surface) shot.echo.range += sensor.lidar.range_noise * rng.normal();
    }
  });
  WeatheredScan result;
  result.cloud.max_range = cloud.max_range;
  for (std::size_t i = 0; i < shots.size(); ++i) {
    if (shots[i].echo.received) {
      pulses.append(i, shots[i], result.cloud);
      result.phantoms.push_back(shots[i].echo.phantom);
    } else {
      result.lost += i < cloud.size();
    }
  }
  return result;
}

}  // namespace perception
