#include "libperception/simulation/recorded/RecordedScan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "libperception/simulation/LidarCaster.h"
#include "libperception/simulation/LidarEcho.h"

namespace perception {
namespace {

constexpr double kUnknownReflectivity = 0.2;  // a mean surface (assumed)
constexpr double kIncidence = 0.7;            // cosine, of what is no road (assumed)
constexpr std::uint32_t kMissingSlot = 1u << 28, kMarginPurpose = 0x400;
constexpr std::size_t kGrain = 2048;  // pulses a task

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
  Vector3 aim;       // unit, sensor frame
  double clear = 0;  // reflectivity in clear air
  LidarEcho echo;
};

// As instruments report it, in 8 bits: the faintest have 0.
double inSteps(double intensity) { return std::round(255 * intensity) / 255; }

template <class T>
void addIf(std::vector<T>& to, const std::vector<T>& from, std::size_t i) {
  if (!from.empty()) to.push_back(from[i]);
}

}  // namespace

WeatheredScan throughWeather(const LidarCloud& cloud, const std::vector<BeamPattern::Beam>& missing,
                             const SimulatedWeather& weather, const SensorParams& sensor,
                             const Pose3& T_world_sensor, const LidarCaster& scene,
                             const RngKey& key) {
  const std::size_t n = cloud.size();
  const Vector3 origin = T_world_sensor.translation();
  std::vector<Vector3> places(n);
  for (std::size_t i = 0; i < n; ++i)
    places[i] =
        T_world_sensor * Vector3(static_cast<double>(cloud.x[i]), static_cast<double>(cloud.y[i]),
                                 static_cast<double>(cloud.z[i]));
  const RoadReturns road(places, origin);
  const LidarParams& lidar = sensor.lidar;
  const double least = 0.9 / (lidar.reference_range * lidar.reference_range);

  std::vector<Shot> shots(n + missing.size());
  scene.parallel(shots.size(), kGrain, [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      Shot& shot = shots[i];
      LidarPulse& pulse = shot.pulse;
      pulse.origin = origin, pulse.scene = &scene;
      std::uint32_t slot = static_cast<std::uint32_t>(i);
      if (i < n) {
        const Vector3 arm = places[i] - origin;
        const double range = std::max(arm.norm(), 1e-3);
        pulse.direction = arm / range;
        shot.aim = T_world_sensor.linear().transpose() * pulse.direction;
        const bool on_road = road.contains(places[i]);
        pulse.hit.range = static_cast<float>(range);
        pulse.hit.object = on_road ? BeamHit::kRoad : BeamHit::kRecorded;
        pulse.hit.material = on_road ? Material::kRoad : Material::kWall;
        pulse.hit.cos_incidence =
            static_cast<float>(on_road ? std::abs(pulse.direction.z()) : kIncidence);
        const double intensity = cloud.intensity.empty() ? kUnknownReflectivity
                                                         : static_cast<double>(cloud.intensity[i]);
        // Of a return at the threshold it is not known by how much it exceeds that.
        Rng margin(key.withSlot(slot).withPurpose(key.purpose ^ kMarginPurpose));
        pulse.reflectivity = shot.clear =
            std::max(intensity, least * range * range * margin.uniform(1.001, 2));
      } else {
        shot.aim = missing[i - n].direction;
        pulse.direction = T_world_sensor.linear() * shot.aim;
        slot = kMissingSlot + missing[i - n].slot;
      }
      pulse.azimuth = std::atan2(shot.aim.y(), shot.aim.x());
      pulse.elevation = std::asin(std::clamp(shot.aim.z(), -1.0, 1.0));
      Rng rng(key.withSlot(slot));
      weather.alter(sensor, pulse, rng);
      shot.echo = echoOf(pulse, pulse.reflectivity, lidar);
      if (!shot.echo.of_surface) shot.echo.range += lidar.range_noise * rng.normal();
    }
  });

  WeatheredScan result;
  result.cloud.max_range = cloud.max_range;
  for (std::size_t i = 0; i < shots.size(); ++i) {
    const Shot& shot = shots[i];
    if (!shot.echo.received) {
      result.lost += i < n;
      continue;
    }
    LidarCloud& out = result.cloud;
    const bool moved =
        i >= n || !shot.echo.of_surface ||
        shot.echo.range != static_cast<double>(static_cast<float>((places[i] - origin).norm()));
    if (moved) {
      const Vector3 p = shot.aim * shot.echo.range;
      out.x.push_back(static_cast<float>(p.x())), out.y.push_back(static_cast<float>(p.y()));
      out.z.push_back(static_cast<float>(p.z()));
    } else {
      out.x.push_back(cloud.x[i]), out.y.push_back(cloud.y[i]), out.z.push_back(cloud.z[i]);
    }
    if (!cloud.intensity.empty()) {
      // What the unit called this surface, times what the weather leaves of it.
      const double scale =
          i < n && shot.echo.of_surface ? shot.echo.intensity / std::min(1.0, shot.clear) : 0;
      out.intensity.push_back(scale > 0 ? cloud.intensity[i] * static_cast<float>(scale)
                                        : static_cast<float>(inSteps(shot.echo.intensity)));
    }
    // What a pulse without a return would have had is not known: as the return before it.
    const std::size_t like = std::min(i, n - 1);
    addIf(out.ring, cloud.ring, like), addIf(out.time_offset, cloud.time_offset, like);
    addIf(out.echo, cloud.echo, like), addIf(out.pulse_width, cloud.pulse_width, like);
    addIf(out.label, cloud.label, like);
    result.phantoms.push_back(shot.echo.phantom);
  }
  return result;
}

}  // namespace perception
