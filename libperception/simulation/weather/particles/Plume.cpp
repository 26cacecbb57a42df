#include "libperception/simulation/weather/particles/Plume.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libperception/core/math/Angle.h"
#include "libperception/simulation/weather/Beam.h"
#include "libperception/simulation/world/World.h"

namespace perception {
namespace {

// method.md 9.5, assumed.
constexpr double kRate = 20;                          // [1/s] puffs
constexpr double kFirstSigma = 0.12, kGrowth = 0.25;  // [m], [m/s^.75]
constexpr double kRise = 0.3;                         // [m/s]
constexpr double kWake = 0.3, kWakeTime = 0.8;        // share of the speed; [s]
constexpr double kSource = 0.5, kLeast = 0.05;        // [1/m] at the pipe, of a return
constexpr double kShortLife = 1.5, kLongLife = 4;     // [s] time constant
constexpr double kOldest = 4;  // [s] all of a plume is thinner than kLeast then
// Puffs that are older overlap so much that one in four stands for all.
constexpr double kJoined = 0.8;  // [s]
constexpr std::int64_t kJoin = 4;
constexpr double kReturn = 0.6;  // chance
constexpr double kDimmest = 5.0 / 255, kBrightestPlume = 15.0 / 255;
constexpr double kPipeHeight = 0.3, kPipeAside = 0.3;  // [m]; share of the vehicle's width
constexpr double kWide = 3;                            // sigmas
constexpr double kPlumeStep = 0.1;                     // [m] along a beam
constexpr std::size_t kMost = 512;                     // puffs on one beam
constexpr std::uint32_t kBirth = 0x57EA4000;           // purpose of random numbers

bool exhausts(const ObjectParams& object) {
  const bool vehicle = object.kind == ObjectKind::kCar || object.kind == ObjectKind::kVan ||
                       object.kind == ObjectKind::kBus;
  return vehicle && object.waypoints.t.size() > 1;  // parked ones are off
}

/// A puff on a beam.
struct PuffOnBeam {
  double middle, sigma, extinction;  // [m] along the beam; [1/m] most on it

  double at(double s) const {
    const double d = (s - middle) / sigma;
    if (std::abs(d) > kWide) return 0;
    return extinction * std::exp(-.5 * d * d);
  }
  double depth() const { return std::sqrt(kTwoPi) * sigma * extinction; }
};

}  // namespace

Plume::Plume(const Vector2& wind, std::uint64_t seed) : wind_(wind.x(), wind.y(), 0), seed_(seed) {}

void Plume::advance(const World& world, const SensorParams& sensor, double t) {
  puffs_.clear(), clouds_.clear();
  if (!sensor.isLidar()) return;
  const EgoState ego = world.ego(t);
  table_.reset((ego.T_world_ego * sensor.T_ego_sensor()).translation().head<2>());
  const double moved = ego.velocity.norm() / sensor.rate;  // during a scan
  for (std::size_t i = 0; i < world.objects(); ++i) {
    const std::size_t first = puffs_.size();
    if (exhausts(world.scenario().objects[i]) && world.present(i, t)) addPuffs(world, i, t);
    if (puffs_.size() == first) continue;
    Cloud cloud{first, puffs_.size(), .5 * (puffs_[first].place + puffs_.back().place), 0};
    for (std::size_t k = first; k < puffs_.size(); ++k) {
      cloud.radius =
          std::max(cloud.radius, (puffs_[k].place - cloud.center).norm() + kWide * puffs_[k].sigma);
    }
    table_.add(cloud.center.head<2>(), cloud.radius + moved,
               static_cast<std::uint32_t>(clouds_.size()));
    clouds_.push_back(cloud);
  }
}

// Where each puff is follows from when it left the pipe.
void Plume::addPuffs(const World& world, std::size_t object, double t) {
  const ObjectParams& vehicle = world.scenario().objects[object];
  const Vector2 center = world.object(object, t).T_world_object.translation().head<2>();
  if ((center - table_.eye()).norm() > 80) return;  // too thin to be seen from there
  const Vector3 pipe(-.5 * vehicle.length, -kPipeAside * vehicle.width, kPipeHeight);
  const auto last = static_cast<std::int64_t>(std::floor(t * kRate));
  for (auto n = last; static_cast<double>(n) / kRate > t - kOldest; --n) {
    const double born = static_cast<double>(n) / kRate, age = t - born;
    if (age > kJoined && n % kJoin != 0) continue;
    const ObjectState state = world.object(object, born);
    Rng rng({seed_, static_cast<std::uint64_t>(n + (std::int64_t{1} << 32)),
             static_cast<std::uint32_t>(object), kBirth});
    const double life = rng.uniform(kShortLife, kLongLife);
    Puff puff;
    puff.sigma = kFirstSigma + kGrowth * std::pow(age, 0.75);
    puff.extinction = kSource * std::pow(kFirstSigma / puff.sigma, 3) * std::exp(-age / life);
    if (age > kJoined) puff.extinction *= kJoin;
    const double drift = kWake * kWakeTime * (1 - std::exp(-age / kWakeTime));
    puff.place = state.T_world_object * pipe + age * wind_ +
                 Vector3(drift * state.velocity.x(), drift * state.velocity.y(), kRise * age);
    puffs_.push_back(puff);
  }
}

// The first place where the depth exceeds a drawn one and the plume is dense enough.
void Plume::alter(const SensorParams&, LidarPulse& pulse, Rng& rng) const {
  const auto& items = table_.along(pulse.direction);
  if (items.empty()) return;
  const double open = openRange(pulse);
  std::array<PuffOnBeam, kMost> parts;
  std::size_t count = 0;
  double depth = 0, from = open, to = 0;
  for (const std::uint32_t item : items) {
    const Cloud& cloud = clouds_[item];
    const Vector3 towards = cloud.center - pulse.origin;
    const double nearest = towards.dot(pulse.direction);
    if (towards.squaredNorm() - nearest * nearest > cloud.radius * cloud.radius ||
        nearest + cloud.radius <= 0 || nearest - cloud.radius >= open) {
      continue;
    }
    for (std::size_t k = cloud.from; k < cloud.to; ++k) {
      const Puff& puff = puffs_[k];
      const Vector3 arm = puff.place - pulse.origin;
      const double middle = arm.dot(pulse.direction);
      const double aside = (arm.squaredNorm() - middle * middle) / (puff.sigma * puff.sigma);
      if (aside > kWide * kWide || middle <= 0 || middle >= open || count == kMost) continue;
      parts[count] = {middle, puff.sigma, puff.extinction * std::exp(-.5 * aside)};
      depth += parts[count].depth();
      from = std::min(from, middle - kWide * puff.sigma);
      to = std::max(to, middle + kWide * puff.sigma);
      ++count;
    }
  }
  if (count == 0) return;
  const double drawn = -std::log1p(-rng.uniform());
  pulse.optical_depth += depth;
  if (depth < drawn || rng.uniform() >= kReturn) return;
  double passed = 0;
  for (double s = std::max(kPlumeStep, from); s < std::min(to, open); s += kPlumeStep) {
    double here = 0;
    for (std::size_t i = 0; i < count; ++i) here += parts[i].at(s);
    passed += kPlumeStep * here;
    if (passed < drawn || here < kLeast) continue;
    LidarPulse::Scatterer cloud;
    cloud.range = s - rng.uniform(0, kPlumeStep);
    cloud.intensity = rng.uniform(kDimmest, kBrightestPlume);
    cloud.phantom = Phantom::kPlume;
    pulse.scatterers.push_back(cloud);
    return;
  }
}

}  // namespace perception
