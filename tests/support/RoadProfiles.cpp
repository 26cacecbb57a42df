#include "tests/support/RoadProfiles.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libperception/core/math/Angle.h"
#include "libperception/core/math/Random.h"

namespace perception::test {
namespace {

constexpr double kTableStep = 0.05;  // [m]
constexpr double kBefore = 120;  // [m] of straight road before the first and after the last piece
constexpr double kWheelbase = 2.7;                                  // [m]
constexpr double kKerbAt = 3.5, kBesideFrom = 4;                    // [m] across the road
constexpr double kDeckWidth = 16, kDeckThickness = 1, kRoom = 4.5;  // [m] of a bridge; below it

/// The curve from `before` to `after` of a circle of that radius.
RoadPiece curve(double before, double after, double radius) {
  return {std::abs(after - before) * radius, after};
}

std::vector<RoadPiece> bend(double before, double after, double radius, double at = 50) {
  return {{at, before}, curve(before, after, radius), {60, after}};
}

/// Down (or up) from the level by `slope` over `ramp` meters and level again.
std::vector<RoadPiece> level(double slope, double radius, double ramp) {
  return {{40, 0}, curve(0, slope, radius), {ramp, slope}, curve(slope, 0, radius), {50, 0}};
}

/// Between two slopes and back.
std::vector<RoadPiece> wave(double slope, double radius, double straight) {
  return {{40, slope},
          curve(slope, -slope, radius),
          {straight, -slope},
          curve(-slope, slope, radius),
          {50, slope}};
}

RoadProfile named(const char* name, std::vector<RoadPiece> pieces, double speed = 10) {
  RoadProfile profile;
  profile.name = name;
  profile.pieces = std::move(pieces);
  profile.speed = speed;
  return profile;
}

RoadProfile with(RoadProfile profile, void (*change)(RoadProfile&)) {
  change(profile);
  return profile;
}

}  // namespace

const std::vector<RoadProfile>& roadProfiles() {
  static const std::vector<RoadProfile> all = {
      named("sag of 10 %, radius 100 m", bend(-.10, 0, 100)),
      named("sag of 10 %, radius 80 m", bend(-.10, 0, 80)),
      named("sag of 10 %, radius 60 m", bend(-.10, 0, 60)),
      named("sag of 15 %, radius 50 m", bend(-.15, 0, 50), 8),
      named("sag of 6 %, radius 300 m", bend(-.06, 0, 300)),
      named("crest of 10 %, radius 100 m", bend(.10, 0, 100)),
      named("crest of 15 %, radius 50 m", bend(.15, 0, 50), 8),
      named("ramp of 12 %, radius 20 m", level(.12, 20, 30), 3),
      named("garage ramp of 15 %, radius 20 m", level(-.15, 20, 20), 3),
      named("valley of 15 %, radius 50 m", wave(-.15, 50, 10), 8),
      named("hump of 8 %, radius 50 m", wave(.08, 50, 5), 8),
      named("waves of 4 %, radius 150 m", wave(.04, 150, 0)),
      with(named("sag of 8 % between kerbs", bend(-.08, 0, 100)),
           [](RoadProfile& p) { p.kerb = 0.15; }),
      with(named("speed bumps on a slope of 6 %", bend(-.06, 0, 100), 6),
           [](RoadProfile& p) {
             p.bumps = {{30, 1, .1}, {55, 4, .12}, {75, .6, .08}};
           }),
      with(named("underpass of 8 %, radius 80 m", wave(-.08, 80, 10)),
           [](RoadProfile& p) {
             p.decks = {{45, 57}};
           }),
      with(named("road beside a ramp down to another level", {{110, 0}}),
           [](RoadProfile& p) { p.beside = level(-.12, 30, 30); }),
      with(named("ramp down beside a road", level(-.12, 30, 30), 6),
           [](RoadProfile& p) {
             p.beside = {{150, 0}};
           }),
      with(named("braking at the end of a slope of 10 %", bend(-.10, 0, 100)),
           [](RoadProfile& p) { p.pitch = radians(2); }),
      with(named("crossfall of 6 % in a sag of 8 %", bend(-.08, 0, 80)),
           [](RoadProfile& p) { p.crossfall = .06; }),
      with(named("bridge over a crest of 6 %, radius 120 m", bend(.06, -.06, 120)),
           [](RoadProfile& p) {
             p.decks = {{70, 76}};
           }),
  };
  return all;
}

float Road::Table::at(float x) const {
  const float place = (x + static_cast<float>(kBefore)) / static_cast<float>(kTableStep);
  const auto last = static_cast<float>(height.size() - 2);
  const float bounded = std::clamp(place, 0.0F, last);
  const auto i = static_cast<std::size_t>(bounded);
  return height[i] + (place - static_cast<float>(i)) * (height[i + 1] - height[i]);
}

Road::Table Road::tabulate(const std::vector<RoadPiece>& pieces, double length, bool reversed) {
  Table table;
  const auto count = static_cast<std::size_t>((length + 2 * kBefore) / kTableStep) + 2;
  table.height.reserve(count);
  double height = -kBefore * pieces.front().slope;
  for (std::size_t i = 0; i < count; ++i) {
    table.height.push_back(static_cast<float>(height));
    double begin = 0, before = pieces.front().slope, slope = before;
    const double x = (static_cast<double>(i) + 0.5) * kTableStep - kBefore;
    for (const RoadPiece& piece : pieces) {
      const double along = std::clamp((x - begin) / piece.length, 0.0, 1.0);
      slope = before + along * (piece.slope - before);
      if (x < begin + piece.length) break;
      begin += piece.length, before = piece.slope;
    }
    height += slope * kTableStep;
  }
  if (reversed) std::reverse(table.height.begin(), table.height.end());
  return table;
}

Road::Road(const RoadProfile& profile, bool reversed) : profile_(profile), reversed_(reversed) {
  for (const RoadPiece& piece : profile.pieces) length_ += piece.length;
  road_ = tabulate(profile.pieces, length_, reversed);
  if (!profile.beside.empty()) beside_ = tabulate(profile.beside, length_, reversed);
  addBumps();
  for (const Table* table : {&road_, &beside_})
    for (std::size_t i = 1; i < table->height.size(); ++i)
      steepest_ = std::max(steepest_, std::abs(table->height[i] - table->height[i - 1]) /
                                          static_cast<float>(kTableStep));
  for (auto [from, to] : profile.decks) {
    if (reversed) from = length_ - from, to = length_ - to, std::swap(from, to);
    const double below = std::max(heightAt(from, 0), heightAt(to, 0)) + kRoom;
    decks_.push_back(
        {{(from + to) / 2, 0}, 0, to - from, kDeckWidth, below, below + kDeckThickness});
  }
}

void Road::addBumps() {
  for (const RoadBump& bump : profile_.bumps) {
    const double at = reversed_ ? length_ - bump.at : bump.at;
    for (std::size_t i = 0; i < road_.height.size(); ++i) {
      const double x = static_cast<double>(i) * kTableStep - kBefore;
      const double along = (x - at) / bump.length;
      if (std::abs(along) < 0.5)
        road_.height[i] += static_cast<float>(bump.height * (0.5 + 0.5 * std::cos(kTwoPi * along)));
    }
  }
}

float Road::surfaceAt(float x, float y) const {
  const float left = reversed_ ? -y : y;
  if (left > static_cast<float>(kBesideFrom) && !beside_.height.empty()) return beside_.at(x);
  const float height = road_.at(x) + static_cast<float>(profile_.crossfall) * left;
  return std::abs(y) > static_cast<float>(kKerbAt) ? height + static_cast<float>(profile_.kerb)
                                                   : height;
}

double Road::heightAt(double x, double y) const {
  return static_cast<double>(surfaceAt(static_cast<float>(x), static_cast<float>(y)));
}

Pose3 Road::vehicleAt(double x) const {
  const double rear = heightAt(x, 0), front = heightAt(x + kWheelbase, 0);
  const double side = (heightAt(x, 0.7) - heightAt(x, -0.7)) / 1.4;
  return makePose(x, 0, rear, 0, -std::atan2(front - rear, kWheelbase) + profile_.pitch,
                  std::atan(side));
}

/// Steps no longer than the surface allows, then bisection.
float Road::rangeTo(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction,
                    float far) const {
  const auto above = [&](float t) {
    const Eigen::Vector3f p = origin + t * direction;
    return p.z() - surfaceAt(p.x(), p.y());
  };
  const auto fall = static_cast<float>(std::abs(profile_.crossfall));
  const float closing = steepest_ + fall + std::max(0.02F, -direction.z());
  float last = 0.5F;
  for (float t = last; t < far;) {
    const float gap = above(t);
    if (gap < 0) {
      float low = last, high = t;
      for (int k = 0; k < 14; ++k) {
        const float middle = (low + high) / 2;
        (above(middle) < 0 ? high : low) = middle;
      }
      return high;
    }
    last = t;
    t += std::max(0.02F + 0.002F * t, (gap - 0.15F) / closing);
  }
  return std::numeric_limits<float>::infinity();
}

SensorFrame Road::castFrom(double x, const SpinningLidar& lidar, const std::vector<SolidBox>& boxes,
                           Stamp stamp, std::uint64_t seed) const {
  SensorFrame frame;
  frame.sensor = "LIDAR_TOP";
  frame.stamp = frame.ego.stamp = stamp;
  frame.ego.T_world_ego = vehicleAt(x);
  frame.T_ego_sensor = lidar.T_ego_sensor;
  std::vector<SolidBox> solids = decks_;
  for (SolidBox box : boxes) {
    const double ground = heightAt(box.center.x(), box.center.y());
    box.bottom += ground, box.top += ground;
    solids.push_back(box);
  }
  const Pose3 pose = frame.T_world_sensor();
  const Eigen::Vector3f origin = pose.translation().cast<float>();
  LidarCloud cloud;
  Rng rng(RngKey{seed, static_cast<std::uint64_t>(stamp.ns), 0, 0x726f6164});
  const int steps = static_cast<int>(std::floor(lidar.fov / lidar.azimuth_step));
  for (int beam = 0; beam < lidar.beams; ++beam) {
    const double elevation =
        lidar.lowest + (lidar.highest - lidar.lowest) * beam / (lidar.beams - 1);
    for (int step = 0; step < steps; ++step) {
      const double azimuth = -lidar.fov / 2 + (step + 0.5) * lidar.azimuth_step;
      const Vector3 ray(std::cos(elevation) * std::cos(azimuth),
                        std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      const Vector3 direction = pose.linear() * ray;
      const auto far = static_cast<float>(lidar.range_max);
      auto range = static_cast<double>(rangeTo(origin, direction.cast<float>(), far));
      for (const SolidBox& box : solids)
        range = std::min(range, rangeToBox(box, pose.translation(), direction));
      if (!(range < lidar.range_max)) continue;
      const Vector3 p = ray * (range + rng.normal(0, lidar.range_sigma));
      cloud.x.push_back(static_cast<float>(p.x()));
      cloud.y.push_back(static_cast<float>(p.y()));
      cloud.z.push_back(static_cast<float>(p.z()));
    }
  }
  frame.data = std::move(cloud);
  return frame;
}

}  // namespace perception::test
