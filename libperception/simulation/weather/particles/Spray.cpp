#include "libperception/simulation/weather/particles/Spray.h"

#include <algorithm>
#include <cmath>

#include "libperception/simulation/weather/Beam.h"
#include "libperception/simulation/world/World.h"

namespace perception {
namespace {

// method.md 9.4 [linnhoff2022a].
constexpr double kOffset = 50, kSnowOffset = 15;   // [km/h] from where on there is spray, snow dust
constexpr double kWidth = 3.4, kHeight = 1.5;      // [m] of the box in which clusters are born
constexpr double kLargestRadius = 1, kUpward = 5;  // [m], [m/s]
constexpr double kExtinction = 0.02;               // [1/m]
constexpr double kLives = 4;                       // time constants until a cluster is removed
constexpr double kShortestLife = 0.05;             // [s]
constexpr std::int64_t kWarmUp = 30;               // cycles before t = 0
constexpr double kLookHeight = 1;                  // [m] of the line of sight to an object
constexpr std::uint32_t kDropletBirth = 0x57EA3000;  // purpose of random numbers

bool whirls(ObjectKind kind) {
  return kind == ObjectKind::kCar || kind == ObjectKind::kVan || kind == ObjectKind::kBus;
}

/// Where a ray is inside of a sphere.
struct Chord {
  double middle, length;  // [m] along the ray; no length: it passes by
};
Chord chordOf(const Spray::Cluster& c, const Vector3& origin, const Vector3& direction) {
  const Vector3 arm = c.position - origin;
  const double middle = arm.dot(direction);
  const double square = c.radius * c.radius - (arm.squaredNorm() - middle * middle);
  return {middle, square > 0 ? 2 * std::sqrt(square) : 0};
}

}  // namespace

// Snow counts as a film of 1 mm where all is covered.
Spray::Spray(double film_mm, double snow_cover, const Vector2& wind, std::uint64_t seed)
    : film_(std::max(film_mm, snow_cover)),
      offset_kmh_(snow_cover > 0 ? kSnowOffset : kOffset),
      wind_(wind.x(), wind.y(), 0),
      seed_(seed),
      cycle_(-kWarmUp) {}

double Spray::born(double speed) const {
  return (0.2 * film_ + 0.1) * std::max(0.0, 3.6 * speed - offset_kmh_);
}

// Clusters as they were at the last cycle; those shown have moved on to t.
void Spray::advance(const World& world, const SensorParams& sensor, double t) {
  for (; static_cast<double>(cycle_) * kCycle <= t + 1e-9; ++cycle_) {
    step();
    for (std::size_t i = 0; i < world.objects(); ++i) {
      const double now = static_cast<double>(cycle_) * kCycle;
      if (whirls(world.scenario().objects[i].kind) && world.present(i, now)) {
        emit(world, i, now);
      }
    }
  }
  shown_.clear();
  if (!sensor.isLidar() && !sensor.isCamera()) return;
  const EgoState ego = world.ego(t);
  table_.reset((ego.T_world_ego * sensor.T_ego_sensor()).translation().head<2>());
  const double ahead = t - static_cast<double>(cycle_ - 1) * kCycle;
  const double moved = ego.velocity.norm() / sensor.rate;  // during a scan
  for (const Cluster& c : clusters_) {
    Cluster now = c;
    now.position += ahead * c.velocity, now.age += ahead;
    table_.add(now.position.head<2>(), now.radius + moved,
               static_cast<std::uint32_t>(shown_.size()));
    shown_.push_back(now);
  }
}

void Spray::step() {
  for (Cluster& c : clusters_) {
    c.position += kCycle * c.velocity;
    c.position.z() = std::max(0.0, c.position.z());
    const Vector3 against = c.velocity - wind_;
    c.velocity += std::max(-1.0, c.drag * against.norm() * kCycle) * against;
    c.age += kCycle;
  }
  clusters_.erase(std::remove_if(clusters_.begin(), clusters_.end(),
                                 [](const Cluster& c) { return c.age > kLives * c.life; }),
                  clusters_.end());
}

void Spray::emit(const World& world, std::size_t object, double t) {
  const ObjectState state = world.object(object, t);
  const double speed = state.velocity.norm(), mean = born(speed);
  if (mean <= 0) return;
  Rng rng({seed_, static_cast<std::uint64_t>(cycle_ + kWarmUp), static_cast<std::uint32_t>(object),
           kDropletBirth});
  const double whole = std::floor(mean);
  const int count = static_cast<int>(whole) + (rng.uniform() < mean - whole ? 1 : 0);
  const double rear = -.5 * world.scenario().objects[object].length;
  const double life = 0.02 * film_ * (3.6 * speed - offset_kmh_) + 0.2;  // [s]
  for (int i = 0; i < count; ++i) {
    Cluster c;
    c.position =
        state.T_world_object * Vector3(rear - rng.uniform(0, speed * kCycle),
                                       rng.uniform(-.5, .5) * kWidth, rng.uniform(0, kHeight));
    c.velocity = {state.velocity.x(), state.velocity.y(), rng.uniform(0, kUpward)};
    c.radius = std::min(kLargestRadius, std::exp(rng.normal(-1.2, 0.8)));
    c.age = 0, c.life = std::max(kShortestLife, rng.normal(life, 0.2));
    c.detection = std::min(1.0, std::exp(rng.normal(-2.3, 1.1)));
    c.drag = std::min(0.0, rng.normal(-0.12, 0.04));
    clusters_.push_back(c);
  }
}

void Spray::alter(const SensorParams&, LidarPulse& pulse, Rng& rng) const {
  const double open = openRange(pulse);
  for (const std::uint32_t item : table_.along(pulse.direction)) {
    const Cluster& c = shown_[item];
    const Chord chord = chordOf(c, pulse.origin, pulse.direction);
    if (chord.length <= 0 || chord.middle <= 0 || chord.middle >= open) continue;
    pulse.optical_depth += kExtinction * chord.length;
    if (rng.uniform() >= c.detection * std::exp(-c.age / c.life)) continue;
    LidarPulse::Scatterer drops;
    drops.range = rng.normal(chord.middle, chord.length / 6);
    drops.intensity = std::max(0.0, rng.normal(0.5, 0.05)) / 255;
    drops.phantom = Phantom::kSpray;
    if (drops.range > 0 && drops.range < open) pulse.scatterers.push_back(drops);
  }
}

void Spray::alter(const SensorParams&, CameraLook& look, Rng&) const {
  const Vector3 eye(table_.eye().x(), table_.eye().y(), kLookHeight);
  const Vector3 sight(std::cos(look.azimuth), std::sin(look.azimuth), 0);
  for (const std::uint32_t item : table_.along(sight)) {
    const Chord chord = chordOf(shown_[item], eye, sight);
    if (chord.middle > 0 && chord.middle < look.range)
      look.optical_depth += kExtinction * chord.length;
  }
}

}  // namespace perception
