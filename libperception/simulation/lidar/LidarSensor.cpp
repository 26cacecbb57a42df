#include "libperception/simulation/lidar/LidarSensor.h"

#include <algorithm>
#include <cmath>

#include "libperception/simulation/lidar/LidarCaster.h"
#include "libperception/simulation/lidar/LidarEcho.h"
#include "libperception/simulation/lidar/LidarSurface.h"
#include "libperception/simulation/world/World.h"

namespace perception {
namespace {

constexpr double kRangeUnit = 0.09;  // [m] dR of method.md (57): sigma = dR / sqrt(2 SNR)
constexpr double kSpeckle = 0.12;    // relative spread of the echo's power, rough surfaces
constexpr double kCoordinateUnit =
    1.0 / 512;                           // [m] HDL-64E: 2 mm; a power of two, as it packs well
constexpr double kIntensityUnit = 0.01;  // as in KITTI's files
constexpr std::size_t kGrain = 2048;     // beams a task
constexpr int kSlices = 36;              // of a sweep: 10 deg of a turn each
constexpr std::uint32_t kLidarWeatherPurpose = 0x57EA0000;  // its own stream of random numbers

double quantized(double value, double unit) { return std::round(value / unit) * unit; }

/// A received echo of a pulse.
struct Echo {
  bool on_object = false;                   ///< else road or air
  PointLabel label = PointLabel::kUnknown;  ///< the sensor's own (four layers)
  double range = 0;                         ///< [m]
  double intensity = 0;  ///< [0, 1] corrected for range, as the instrument reports it
  double width = 0;      ///< [m] of the pulse (four layers, in weather)
  Phantom phantom = Phantom::kNone;
};
using Echoes = std::vector<Echo>;  // of one pulse, by range

LidarPulse pulseOn(const BeamHit& hit, const Vector3& origin, const Vector3& direction,
                   double reflectivity_factor) {
  LidarPulse pulse;
  pulse.origin = origin, pulse.direction = direction;
  pulse.hit = hit;
  if (hit.object == BeamHit::kNothing) return pulse;
  pulse.reflectivity = reflectivity_factor * lidarReflectivity(hit);
  pulse.lost = lidarSurface(hit.material).lost;
  return pulse;
}

// Depth of the surface within the beam [m].
double slantOf(const LidarPulse& pulse, const LidarEcho& echo) {
  constexpr double kDivergence = 3e-3, kLeast = 0.02;  // [rad]; cosine
  if (!echo.of_surface) return 0;
  const double cosine = std::max(kLeast, static_cast<double>(pulse.hit.cos_incidence));
  return kDivergence * echo.range * std::sqrt(std::max(0.0, 1 - cosine * cosine)) / cosine;
}

// Of a scanner with own labels in weather: the surface behind is a second echo, and the first is
// rain by the rule; what it keeps in the air is an object to it, but for images below the road.
void addSecondEcho(const LidarPulse& pulse, LidarEcho found, double reflectivity,
                   const LidarSensorParams& p, Echoes& echoes) {
  found.width = echoes[0].width = pulseWidth(found.level, slantOf(pulse, found));
  if (found.of_surface) return;
  const bool below = found.phantom == Phantom::kMirror;
  echoes[0].label = below ? PointLabel::kGround : PointLabel::kObject;
  auto second = secondEchoOf(pulse, found, reflectivity, p);
  if (!second) return;
  second->width = pulseWidth(second->level, slantOf(pulse, *second));
  if (isRain(found, *second)) echoes[0].label = PointLabel::kRain;
  Echo behind;
  behind.on_object = pulse.hit.object >= 0;
  behind.label = behind.on_object ? PointLabel::kObject : PointLabel::kGround;
  behind.range = second->range, behind.intensity = second->intensity, behind.width = second->width;
  echoes.push_back(behind);
}

// Dirt on the window before a scanner with own labels.
Echo dirtEcho() {
  constexpr double kWindow = 0.1;  // [m], assumed
  Echo echo;
  echo.range = kWindow, echo.label = PointLabel::kDirt;
  echo.intensity = 1, echo.phantom = Phantom::kDirt;
  return echo;
}

// Speckle, losses and noise of one pulse's echoes; `several`: of a scanner that reports more than
// one, with labels, in weather.
Echoes received(const LidarPulse& pulse, const LidarSensorParams& p, bool several, Rng& rng) {
  const bool surface = pulse.hit.object != BeamHit::kNothing && pulse.hit.range >= p.range_min;
  double reflectivity = 0;
  if (surface && rng.uniform() >= pulse.lost + p.loss)
    reflectivity = pulse.reflectivity * std::max(0.0, 1 + kSpeckle * rng.normal());
  const LidarEcho found = echoOf(pulse, reflectivity, p);
  if (!found.received) return several && pulse.blocked ? Echoes{dirtEcho()} : Echoes{};
  Echo echo;
  echo.on_object = found.of_surface && pulse.hit.object >= 0;
  const double noise = found.snr > 0 ? kRangeUnit / std::sqrt(2 * found.snr) : 0;
  const double measured = found.range + rng.normal() * std::hypot(p.range_noise, noise);
  // No instrument reports more, rounding to its unit included.
  echo.range = std::min(measured, p.range_max - kCoordinateUnit);
  echo.intensity = found.intensity, echo.phantom = found.phantom;
  if (p.layout == LidarSensorParams::Layout::kFourLayer) {
    const bool object = echo.on_object != (rng.uniform() < p.label_error);
    echo.label = object ? PointLabel::kObject : PointLabel::kGround;
  }
  Echoes echoes{echo};
  if (several) addSecondEcho(pulse, found, reflectivity, p, echoes);
  return echoes;
}

// Appends an echo to the scan; `several` as in received().
void append(const Echo& echo, const Vector3& direction, bool labelled, bool several, int order,
            LidarCloud& cloud) {
  const Vector3 point = direction * echo.range;
  cloud.x.push_back(static_cast<float>(quantized(point.x(), kCoordinateUnit)));
  cloud.y.push_back(static_cast<float>(quantized(point.y(), kCoordinateUnit)));
  cloud.z.push_back(static_cast<float>(quantized(point.z(), kCoordinateUnit)));
  cloud.intensity.push_back(static_cast<float>(quantized(echo.intensity, kIntensityUnit)));
  if (labelled) cloud.label.push_back(static_cast<std::uint8_t>(echo.label));
  if (!several) return;
  cloud.echo.push_back(static_cast<std::uint8_t>(order));
  cloud.pulse_width.push_back(static_cast<float>(quantized(echo.width, kCoordinateUnit)));
}

/// Part of a beam's section.
struct Ray {
  BeamHit hit;
  double reflectivity, lost, power;  // power: arbitrary units, of the lidar equation
};

// A beam whose rays meet several surfaces: those within one pulse's length are one echo at their
// mean range, and the strongest echo counts with its share of the beam.
LidarPulse joined(LidarPulse center, const std::vector<Ray>& rays) {
  constexpr double kPulseLength = 0.75;  // [m] 5 ns there and back
  std::size_t best = 0;
  double best_power = -1;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    double power = 0;
    for (const Ray& r : rays) {
      if (std::abs(r.hit.range - rays[i].hit.range) < kPulseLength) power += r.power;
    }
    if (power > best_power * (1 + 1e-12)) best = i, best_power = power;
  }
  if (!(best_power > 0)) return center;
  double range = 0, reflectivity = 0, lost = 0, count = 0, strongest = -1;
  for (const Ray& r : rays) {
    if (std::abs(r.hit.range - rays[best].hit.range) >= kPulseLength || r.power <= 0) continue;
    range += r.power * r.hit.range, reflectivity += r.reflectivity, lost += r.lost, ++count;
    if (r.power > strongest) strongest = r.power, center.hit = r.hit;
  }
  center.hit.range = static_cast<float>(range / best_power);
  center.reflectivity = reflectivity / static_cast<double>(rays.size());
  center.lost = lost / count;
  return center;
}

bool onEdge(const BeamHit& a, const BeamHit& b) {
  constexpr float kStep = 0.3F;  // [m]
  return a.object != b.object || (a.object >= 0 && std::abs(a.range - b.range) > kStep);
}

}  // namespace

LidarSensor::LidarSensor(const LidarSensorParams& params, double rate)
    : params_(params), slices_(params.sweep ? kSlices : 1) {
  const std::vector<double> elevations = params.elevations();
  const double width = params.azimuth_to - params.azimuth_from;
  // A whole turn has no beam twice; a part of one has a beam at both ends.
  const bool whole = width > kTwoPi - 1e-9;
  const auto columns =
      static_cast<std::uint32_t>(width / params.azimuth_step + (whole ? 0.5 : 1 + 1e-9));
  slice_time_ = width / kTwoPi / rate / static_cast<double>(slices_.size());
  for (std::uint32_t ring = 0; ring < elevations.size(); ++ring) {
    const double up = elevations[ring];
    if (ring % static_cast<std::uint32_t>(params.ring_step) != 0) continue;
    if (up < params.elevation_from || up > params.elevation_to) continue;
    for (std::uint32_t i = 0; i < columns; ++i) {
      const double azimuth = params.azimuth_from + i * params.azimuth_step;
      const std::size_t slice = i * slices_.size() / columns;
      slices_[slice].push_back(
          {{std::cos(up) * std::cos(azimuth), std::cos(up) * std::sin(azimuth), std::sin(up)},
           azimuth,
           up,
           static_cast<std::uint16_t>(ring),
           ring * columns + i});
    }
  }
}

std::size_t LidarSensor::beams() const {
  std::size_t count = 0;
  for (const auto& slice : slices_) count += slice.size();
  return count;
}

LidarSensor::Scan LidarSensor::scan(LidarCaster& caster, double t, const PoseAt& T_world_sensor,
                                    const RngKey& key, const PulseHook& hook) const {
  const auto& objects = caster.world().scenario().objects;
  Scan result;
  LidarCloud& cloud = result.cloud;
  result.points_on.assign(objects.size(), 0);
  cloud.max_range = params_.range_max;
  const bool labelled = params_.layout == LidarSensorParams::Layout::kFourLayer,
             several = labelled && static_cast<bool>(hook);
  std::vector<Vector3> directions;
  for (std::size_t s = 0; s < slices_.size(); ++s) {
    const double offset = params_.sweep ? (static_cast<double>(s) + .5) * slice_time_ : 0;
    caster.setTime(t + offset);
    const Pose3 pose = T_world_sensor(t + offset);
    directions.clear();
    for (const Beam& beam : slices_[s]) directions.push_back(pose.linear() * beam.direction);
    std::vector<LidarPulse> pulses = pulsesOf(caster, s, pose, directions);
    std::vector<Echoes> echoes(pulses.size());
    caster.parallel(pulses.size(), kGrain, [&](std::size_t from, std::size_t to) {
      for (std::size_t i = from; i < to; ++i) {
        const std::uint32_t slot = slices_[s][i].slot;
        if (hook) {
          Rng weather_rng(key.withSlot(slot).withPurpose(key.purpose ^ kLidarWeatherPurpose));
          pulses[i].azimuth = slices_[s][i].azimuth, pulses[i].elevation = slices_[s][i].elevation;
          pulses[i].scene = &caster;
          hook(pulses[i], weather_rng);
        }
        Rng rng(key.withSlot(slot));
        echoes[i] = received(pulses[i], params_, several, rng);
      }
    });
    for (std::size_t i = 0; i < pulses.size(); ++i) {
      const Beam& beam = slices_[s][i];
      for (std::size_t k = 0; k < echoes[i].size(); ++k) {
        const Echo& echo = echoes[i][k];
        append(echo, beam.direction, labelled, several, static_cast<int>(k), cloud);
        cloud.ring.push_back(beam.ring);
        if (params_.sweep) cloud.time_offset.push_back(static_cast<float>(offset));
        result.surfaces.push_back(pulses[i].hit.object);
        if (hook) result.phantoms.push_back(echo.phantom);
        if (echo.on_object) ++result.points_on[static_cast<std::size_t>(pulses[i].hit.object)];
      }
    }
  }
  return result;
}

// Rays through the middle of all beams; beams whose neighbors meet something else get four more
// rays on the rim of their section.
std::vector<LidarPulse> LidarSensor::pulsesOf(const LidarCaster& caster, std::size_t slice,
                                              const Pose3& pose,
                                              const std::vector<Vector3>& directions) const {
  const auto& objects = caster.world().scenario().objects;
  const Vector3 origin = pose.translation();
  const auto factor = [&](const BeamHit& hit) {
    return hit.object >= 0 ? objects[static_cast<std::size_t>(hit.object)].reflectivity : 1.0;
  };
  const std::vector<BeamHit> hits = caster.cast(origin, directions, params_.range_max);
  std::vector<LidarPulse> pulses(hits.size());
  caster.parallel(hits.size(), kGrain, [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      pulses[i] = pulseOn(hits[i], origin, directions[i], factor(hits[i]));
    }
  });
  if (params_.divergence <= 0) return pulses;
  const auto& beams = slices_[slice];
  std::vector<std::size_t> wide;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const bool before = i > 0 && beams[i - 1].ring == beams[i].ring && onEdge(hits[i - 1], hits[i]);
    const bool after =
        i + 1 < hits.size() && beams[i + 1].ring == beams[i].ring && onEdge(hits[i], hits[i + 1]);
    if (before || after) wide.push_back(i);
  }
  constexpr std::size_t kRim = 4;
  std::vector<Vector3> rim;
  const double spread = 0.7 * std::tan(.5 * params_.divergence);  // rim ray: mean of its quarter
  for (const std::size_t i : wide) {
    const Vector3& d = directions[i];
    const Vector3 across = Vector3::UnitZ().cross(d).normalized(), up = d.cross(across);
    for (const Vector3& aside : {across, up, Vector3(-across), Vector3(-up)}) {
      rim.push_back((d + spread * aside).normalized());
    }
  }
  const std::vector<BeamHit> rim_hits = caster.cast(origin, rim, params_.range_max);
  std::vector<Ray> rays;
  for (std::size_t k = 0; k < wide.size(); ++k) {
    const auto add = [&](const BeamHit& hit) {
      const LidarPulse p = pulseOn(hit, origin, directions[wide[k]], factor(hit));
      const bool something = hit.object != BeamHit::kNothing && hit.range > 0;
      rays.push_back(
          {hit, p.reflectivity, p.lost, something ? p.reflectivity / (hit.range * hit.range) : 0});
    };
    rays.clear();
    add(hits[wide[k]]);
    for (std::size_t r = 0; r < kRim; ++r) add(rim_hits[k * kRim + r]);
    pulses[wide[k]] = joined(pulses[wide[k]], rays);
  }
  return pulses;
}

}  // namespace perception
