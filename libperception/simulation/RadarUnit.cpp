#include "libperception/simulation/RadarUnit.h"

#include <algorithm>
#include <cmath>

#include "libperception/simulation/RadarClutter.h"
#include "libperception/simulation/lidar/LidarCaster.h"
#include "libperception/simulation/world/World.h"

namespace perception {
namespace {

// Slots of random numbers beside those of the objects.
constexpr std::uint32_t kCellSlot = 1u << 20, kRadarFalseSlot = 1u << 21, kClutterSlot = 1u << 22,
                        kRadarWeatherPurpose = 0x57EA0000;
constexpr double kUnderVehicle = 0.02;  // share of the power that propagates under a car, both ways
constexpr double kShadowed = 0.1;  // power beside a stronger target of the same range: not resolved

/// Reflection of a kind of object. Radar cross sections at 77 GHz: usual figures of the literature;
/// the reference is the car.
struct RadarBody {
  double cross_section;                ///< [m^2] of all its centers, seen from near by
  double RadarUnitParams::*detection;  ///< share of scans in which it is resolved at all
  bool vehicle;                        ///< centers on corners and sides; else one
};

RadarBody bodyOf(ObjectKind kind) {
  using P = RadarUnitParams;
  switch (kind) {
    case ObjectKind::kCar:
      return {kCarSection, &P::vehicle, true};
    case ObjectKind::kVan:
      return {16, &P::vehicle, true};
    case ObjectKind::kBus:
      return {40, &P::vehicle, true};
    case ObjectKind::kCyclist:
      return {2, &P::cyclist, false};
    case ObjectKind::kPedestrian:
      return {0.5, &P::person, false};
    case ObjectKind::kPole:
      return {2, &P::surroundings, false};
    case ObjectKind::kBox:
      return {30, &P::surroundings, true};
    case ObjectKind::kBush:
      return {0.3, &P::surroundings, false};
  }
  return {1, &P::surroundings, false};
}

/// A scattering center in the object's frame and its share of the cross section.
struct Center {
  Vector2 place;   // [m] footprint
  Vector2 normal;  // outward; zero: seen from everywhere
  double share;
};

// Corners (two faces meet: a wheel arch, the edge of a bumper) are strong and seen from most
// directions; the middles of sides reflect at normal incidence.
std::vector<Center> centersOf(const RadarBody& body, double length, double width) {
  if (!body.vehicle) return {{Vector2::Zero(), Vector2::Zero(), 1}};
  std::vector<Center> centers;
  const Vector2 half(.5 * length, .5 * width);
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      const Vector2 corner(x, y);
      centers.push_back({half.cwiseProduct(corner), corner.normalized(), 0.25});
    }
  }
  centers.push_back({{half.x(), 0}, Vector2::UnitX(), 0.3});
  centers.push_back({{-half.x(), 0}, -Vector2::UnitX(), 0.3});
  // Long sides have a center every few meters: a bus is several targets.
  const int pieces = std::clamp(static_cast<int>(length / 4), 1, 12);
  for (int i = 0; i < pieces; ++i) {
    const double x = -half.x() + length * (i + .5) / pieces;
    centers.push_back({{x, half.y()}, Vector2::UnitY(), 0.3 / pieces});
    centers.push_back({{x, -half.y()}, -Vector2::UnitY(), 0.3 / pieces});
  }
  return centers;
}

double thresholdSnr(const RadarUnitParams& p) { return std::log(p.false_alarm) / std::log(.5) - 1; }

// Range, bearing and range rate of a point that moves with `velocity`; world.
void look(RadarReflection& r, const Vector2& velocity, const RadarMount& mount) {
  const Vector2 d = r.position - mount.T_world_sensor.translation().head<2>();
  r.range = d.norm();
  r.bearing = wrapAngle(std::atan2(d.y(), d.x()) - yawOf(mount.T_world_sensor));
  r.range_rate = r.range > 0 ? d.dot(velocity - mount.velocity) / r.range : 0;
}

bool inView(const RadarReflection& r, const RadarUnitParams& p) {
  return std::abs(r.bearing) <= .5 * p.fov && r.range >= p.range_min && r.range <= p.range_max;
}

double snrOf(double cross_section, double range, const RadarUnitParams& p) {
  return cross_section / kCarSection * carSnr(range, p);
}

// Share of the power received from `to` [m]: none through walls, a little under vehicles.
double passing(const LidarCaster& caster, const Vector3& from, const Vector2& to, int object) {
  constexpr double kTolerance = 0.6;  // [m] hull and footprint differ
  const Vector3 target(to.x(), to.y(), from.z());
  const double range = (target - from).norm();
  if (range < 1e-6) return 1;
  const BeamHit hit = caster.cast(from, {(target - from) / range}, range).front();
  if (hit.object < 0 || hit.object == object || hit.range > range - kTolerance) return 1;
  const auto kind = caster.world().scenario().objects[static_cast<std::size_t>(hit.object)].kind;
  if (kind == ObjectKind::kBox) return 0;
  if (kind == ObjectKind::kBush || kind == ObjectKind::kPole) return 0.5;
  return isRoadUser(kind) && bodyOf(kind).vehicle ? kUnderVehicle : 0.5;
}

/// One resolution cell: the power of its reflections and their mean.
struct Cell {
  RadarReflection mean;  // power-weighted, snr = sum
  double strongest = 0;
};

bool inCell(const RadarReflection& a, const RadarReflection& b) {
  return std::abs(a.range - b.range) < RadarCell::kRange &&
         std::abs(wrapAngle(a.bearing - b.bearing)) < RadarCell::kBearing &&
         std::abs(a.range_rate - b.range_rate) < RadarCell::kRate;
}

// Greedy clustering from the strongest reflection on: each takes those in its cell.
std::vector<Cell> cellsOf(std::vector<RadarReflection> reflections) {
  std::stable_sort(reflections.begin(), reflections.end(),
                   [](const auto& a, const auto& b) { return a.snr > b.snr; });
  std::vector<Cell> cells;
  std::vector<RadarReflection> seeds;
  for (const RadarReflection& r : reflections) {
    std::size_t k = 0;
    while (k < seeds.size() && !inCell(seeds[k], r)) ++k;
    if (k == seeds.size()) {
      seeds.push_back(r);
      cells.push_back({r, r.snr});
      continue;
    }
    RadarReflection& m = cells[k].mean;
    const double w = r.snr / (m.snr + r.snr);
    m.range += w * (r.range - m.range);
    m.bearing += w * wrapAngle(r.bearing - m.bearing);
    m.range_rate += w * (r.range_rate - m.range_rate);
    m.snr += r.snr;
  }
  return cells;
}

RadarReturn measured(const RadarReflection& r, const RadarUnitParams& p, Rng& rng) {
  RadarReturn out;
  out.range = std::max(0.1, r.range + p.range_noise * rng.normal());
  out.bearing = r.bearing + p.bearing_noise * rng.normal();
  out.range_rate = r.range_rate + p.rate_noise * rng.normal();
  out.amplitude = 10 * std::log10(std::max(1e-3, r.snr));
  return out;
}

// Targets without an object: road echoes, which the weather attenuates, and false alarms.
void addFalse(std::vector<RadarReturn>& list, const RadarUnitParams& p, const RadarMount& mount,
              Rng& rng, const RadarHook& hook, Rng& weather_rng) {
  constexpr double kGroundTo = 40;  // [m] grazing incidence beyond
  const double axis = yawOf(mount.T_world_sensor);
  for (int n = rng.poisson(p.ground_per_scan); n > 0; --n) {
    RadarReflection r;
    r.range = rng.uniform(2, std::min(kGroundTo, p.range_max));
    r.bearing = rng.uniform(-.5, .5) * p.fov;
    const double direction = axis + r.bearing;
    const Vector2 sight(std::cos(direction), std::sin(direction));
    r.position = mount.T_world_sensor.translation().head<2>() + r.range * sight;
    r.range_rate = -mount.velocity.dot(sight);
    r.snr = thresholdSnr(p) * rng.uniform(1, 10);
    if (hook) hook(r, weather_rng);
    const RadarReturn echo = measured(r, p, rng);  // draws in any case: the rest stays the same
    if (r.snr >= thresholdSnr(p)) list.push_back(echo);
  }
  for (int n = rng.poisson(p.false_per_scan); n > 0; --n) {
    constexpr double kFastest = 20;  // [m/s] of false targets
    RadarReflection r;
    r.range = rng.uniform(p.range_min, p.range_max);
    r.bearing = rng.uniform(-.5, .5) * p.fov;
    r.range_rate = rng.uniform(-kFastest, kFastest);
    r.snr = thresholdSnr(p) * rng.uniform(1, 3);
    list.push_back(measured(r, p, rng));
  }
}

}  // namespace

void RadarUnitParams::visit(ParamVisitor& v) {
  v.angle("fov_deg", fov, {1, 360}, "full horizontal field of view");
  v.real("range_min", range_min, {0.1, 50}, "m", "nothing nearer");
  v.real("range_max", range_max, {2, 500}, "m", "nothing farther");
  v.real("reference_range", reference_range, {1, 1000}, "m", "range at which P_D of a car is .5");
  v.real("ground_per_scan", ground_per_scan, {0, 50}, "-", "echoes of the road");
  v.integer("max_targets", max_targets, {1, 1000}, "the strongest are kept");
  v.require(range_min < range_max, "range_min: expected less than range_max");
  v.expert();
  v.boolean("upside_down", upside_down,
            "mounted upside down: bearings are mirrored, the pose is not");
}

double carSnr(double range, const RadarUnitParams& p) {
  return thresholdSnr(p) * std::pow(p.reference_range / range, 4);
}

std::vector<RadarReflection> radarReflections(const LidarCaster& caster, double t,
                                              const RadarUnitParams& params,
                                              const RadarMount& mount) {
  const World& world = caster.world();
  const Vector3 eye = mount.T_world_sensor.translation();
  std::vector<RadarReflection> reflections;
  for (std::size_t i = 0; i < world.objects(); ++i) {
    const ObjectParams& object = world.scenario().objects[i];
    const RadarBody body = bodyOf(object.kind);
    const ObjectState state = world.object(i, t);
    const Vector2 center = state.T_world_object.translation().head<2>();
    const double reach = .5 * std::hypot(object.length, object.width);
    if ((center - eye.head<2>()).norm() - reach > params.range_max) continue;
    const Matrix2 turn = state.T_world_object.linear().topLeftCorner<2, 2>();
    for (const Center& c : centersOf(body, object.length, object.width)) {
      RadarReflection r;
      r.object = static_cast<int>(i);
      const Vector2 arm = turn * c.place;
      r.position = center + arm;
      look(r, state.velocity + state.yaw_rate * Vector2(-arm.y(), arm.x()), mount);
      if (!inView(r, params)) continue;
      const Vector2 towards = (eye.head<2>() - r.position) / r.range;
      const double body_heading =
          c.normal.isZero() ? 1 : std::max(0.0, (turn * c.normal).dot(towards));
      if (body_heading <= 0) continue;
      const double share = c.share * body_heading * passing(caster, eye, r.position, r.object);
      r.snr = snrOf(share * body.cross_section, r.range, params);
      if (r.snr > 0) reflections.push_back(r);
    }
  }
  return reflections;
}

RadarReturns radarReturns(const LidarCaster& caster, double t, const RadarUnitParams& p,
                          const RadarMount& mount, const RngKey& key, const RadarHook& hook,
                          const RadarAir& air) {
  const auto& objects = caster.world().scenario().objects;
  std::vector<char> resolved(objects.size());
  for (std::size_t i = 0; i < objects.size(); ++i) {
    Rng rng(key.withSlot(static_cast<std::uint32_t>(i)));
    resolved[i] = rng.uniform() < p.*(bodyOf(objects[i].kind).detection);
  }
  std::vector<RadarReflection> seen;
  Rng weather_rng(key.withPurpose(key.purpose ^ kRadarWeatherPurpose));
  for (RadarReflection& r : radarReflections(caster, t, p, mount)) {
    if (hook) hook(r, weather_rng);
    if (resolved[static_cast<std::size_t>(r.object)] && r.snr > 0) seen.push_back(r);
  }
  // Swerling 1: the power of a cell is exponential about its mean, P_D = P_fa^(1 / (1 + SNR)).
  Rng rng(key.withSlot(kCellSlot));
  std::vector<Cell> found;
  for (Cell& cell : cellsOf(std::move(seen))) {
    const bool detected = rng.uniform() < std::pow(p.false_alarm, 1 / (1 + cell.mean.snr));
    cell.strongest = cell.mean.snr * rng.exponential(1);
    if (detected) found.push_back(cell);
  }
  std::vector<RadarReturn> list;
  for (const Cell& cell : found) {
    const bool shadowed = std::any_of(found.begin(), found.end(), [&](const Cell& other) {
      return std::abs(other.mean.range - cell.mean.range) < RadarCell::kRange &&
             cell.strongest < kShadowed * other.strongest;
    });
    if (shadowed) continue;
    list.push_back(measured(cell.mean, p, rng));
    constexpr double kBounceWithin = 20;  // [m] weaker beyond
    if (cell.mean.range < kBounceWithin && 2 * cell.mean.range < p.range_max &&
        rng.uniform() < p.double_bounce) {
      RadarReflection ghost = cell.mean;
      ghost.range *= 2, ghost.range_rate *= 2, ghost.snr *= 0.01;
      list.push_back(measured(ghost, p, rng));
    }
  }
  Rng false_rng(key.withSlot(kRadarFalseSlot));
  addFalse(list, p, mount, false_rng, hook, weather_rng);
  Rng clutter_rng(key.withSlot(kClutterSlot));
  for (const RadarReflection& r : radarClutter(air, p, mount, clutter_rng))
    list.push_back(measured(r, p, clutter_rng));
  std::stable_sort(list.begin(), list.end(),
                   [](const auto& a, const auto& b) { return a.amplitude > b.amplitude; });
  if (list.size() > static_cast<std::size_t>(p.max_targets)) {
    list.resize(static_cast<std::size_t>(p.max_targets));
  }
  std::stable_sort(list.begin(), list.end(),
                   [](const auto& a, const auto& b) { return a.range < b.range; });
  RadarReturns returns;
  returns.max_range = p.range_max;
  for (RadarReturn& r : list) {
    if (p.upside_down) r.bearing = -r.bearing;
    returns.returns.push_back(r);
  }
  return returns;
}

}  // namespace perception
