#include "libperception/importers/truth/SecondVehicle.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "libperception/core/Error.h"

namespace perception {
namespace {

constexpr double kGap = 2;          ///< [s] between fixes that are bridged
constexpr double kPsd = 2;          ///< [m^2/s^3] of acceleration: a car in a town (assumed)
constexpr double kFirstSpeed = 20;  ///< [m/s] deviation before the first fixes
constexpr double kMoves = 1;        ///< [m/s] slower, the course is no heading
constexpr double kShortest = 3;     ///< [standard deviations of a fix] rms extent of the own way
constexpr std::size_t kFewestFixes = 3;  ///< own fixes

/// Position and velocity along one axis, or of both with one covariance.
struct Motion {
  Vector2 x = Vector2::Zero(), y = Vector2::Zero();  // place, velocity
  Matrix2 P = Matrix2::Identity();
};

struct Step {
  Stamp stamp;
  const PlaceFix* fix = nullptr;    // of the other vehicle
  const FramePose* pose = nullptr;  // instant of the truth
  Motion predicted, filtered;
  double dt = 0;
};

Matrix2 transition(double dt) {
  Matrix2 F;
  F << 1, dt, 0, 1;
  return F;
}

void predict(Motion& m, double dt) {
  const Matrix2 F = transition(dt);
  Matrix2 Q;
  Q << dt * dt * dt / 3, dt * dt / 2, dt * dt / 2, dt;
  m.x = F * m.x, m.y = F * m.y;
  m.P = F * m.P * F.transpose() + kPsd * Q;
}

void update(Motion& m, const PlaceFix& fix) {
  const Vector2 K = m.P.col(0) / (m.P(0, 0) + fix.sigma * fix.sigma);
  m.x += K * (fix.place.x() - m.x[0]);
  m.y += K * (fix.place.y() - m.y[0]);
  m.P -= K * m.P.row(0).eval();
}

/// Rauch, Tung and Striebel [barshalom2001]: forwards, then backwards.
void smooth(std::vector<Step>& steps) {
  Motion m;
  m.x[0] = steps.front().fix->place.x(), m.y[0] = steps.front().fix->place.y();
  m.P << 1e4, 0, 0, kFirstSpeed * kFirstSpeed;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    steps[i].dt = i == 0 ? 0 : steps[i].stamp - steps[i - 1].stamp;
    predict(m, steps[i].dt);
    steps[i].predicted = m;
    if (steps[i].fix != nullptr) update(m, *steps[i].fix);
    steps[i].filtered = m;
  }
  for (std::size_t i = steps.size() - 1; i-- > 0;) {
    Motion& now = steps[i].filtered;
    const Step& next = steps[i + 1];
    const Matrix2 G = now.P * transition(next.dt).transpose() * next.predicted.P.inverse();
    now.x += G * (next.filtered.x - next.predicted.x);
    now.y += G * (next.filtered.y - next.predicted.y);
    now.P += G * (next.filtered.P - next.predicted.P) * G.transpose();
  }
}

/// Place of the antenna by the poses, linear between them.
std::optional<Vector2> antennaAt(const std::vector<FramePose>& poses, const Vector2& antenna,
                                 Stamp stamp) {
  const auto next = std::lower_bound(poses.begin(), poses.end(), stamp,
                                     [](const FramePose& p, Stamp t) { return p.stamp < t; });
  if (next == poses.end() || (next == poses.begin() && stamp < next->stamp)) return std::nullopt;
  const Vector3 lever(antenna.x(), antenna.y(), 0);
  const Vector2 b = (next->T_world_ego * lever).head<2>();
  if (next->stamp == stamp) return b;
  const FramePose& before = *(next - 1);
  const double dt = next->stamp - before.stamp;
  if (dt > kGap) return std::nullopt;
  const Vector2 a = (before.T_world_ego * lever).head<2>();
  return a + (stamp - before.stamp) / dt * (b - a);
}

std::vector<FramePose> sorted(std::vector<FramePose> poses) {
  std::stable_sort(poses.begin(), poses.end(),
                   [](const FramePose& a, const FramePose& b) { return a.stamp < b.stamp; });
  return poses;
}

}  // namespace

WorldAlignment alignToWorld(const std::vector<PlaceFix>& fixes, const Vector2& antenna,
                            const std::vector<FramePose>& poses) {
  const std::vector<FramePose> in_order = sorted(poses);
  std::vector<std::pair<Vector2, Vector2>> pairs;  // by GNSS, by the poses
  Vector2 mean_fix = Vector2::Zero(), mean_way = Vector2::Zero();
  double variance = 0;
  for (const PlaceFix& fix : fixes) {
    const auto way = antennaAt(in_order, antenna, fix.stamp);
    if (!way) continue;
    pairs.emplace_back(fix.place, *way);
    mean_fix += fix.place, mean_way += *way, variance += fix.sigma * fix.sigma;
  }
  const auto n = static_cast<double>(pairs.size());
  if (pairs.size() < kFewestFixes)
    throw DataError(
        fmt::format("{} GNSS fixes of the own vehicle beside its poses, expected {} "
                    "or more: the world frame has no place on Earth",
                    pairs.size(), kFewestFixes));
  mean_fix /= n, mean_way /= n;
  double c = 0, s = 0, extent = 0;
  for (const auto& [fix, way] : pairs) {
    const Vector2 a = fix - mean_fix, b = way - mean_way;
    c += a.dot(b), s += a.x() * b.y() - a.y() * b.x(), extent += b.squaredNorm();
  }
  if (extent / n < kShortest * kShortest * variance / n)
    throw DataError(
        fmt::format("the own vehicle's way, {:.1f} m (rms) about its middle, is too "
                    "short for fixes of {:.1f} m to show where north is",
                    std::sqrt(extent / n), std::sqrt(variance / n)));
  WorldAlignment out;
  out.yaw = std::atan2(s, c);
  out.shift = mean_way - rotate2(out.yaw, mean_fix);
  for (const auto& [fix, way] : pairs)
    out.rms += (rotate2(out.yaw, fix) + out.shift - way).squaredNorm() / n;
  out.sigma_yaw = std::sqrt(out.rms / 2 / extent);
  out.rms = std::sqrt(out.rms);
  out.used = pairs.size();
  return out;
}

std::vector<TruthObject> truthOfVehicle(const std::vector<PlaceFix>& fixes,
                                        const WorldAlignment& alignment,
                                        const OtherVehicle& vehicle,
                                        const std::vector<FramePose>& poses, Stamp first) {
  std::vector<PlaceFix> placed = fixes;
  std::stable_sort(placed.begin(), placed.end(),
                   [](const PlaceFix& a, const PlaceFix& b) { return a.stamp < b.stamp; });
  for (PlaceFix& fix : placed) fix.place = rotate2(alignment.yaw, fix.place) + alignment.shift;
  const std::vector<FramePose> instants = sorted(poses);
  std::vector<Step> steps;
  auto pose = instants.begin();
  for (std::size_t i = 0; i < placed.size(); ++i) {
    while (pose != instants.end() && pose->stamp < placed[i].stamp) {
      // Instants before the first fix and in gaps have no truth.
      if (i > 0 && placed[i].stamp - placed[i - 1].stamp <= kGap)
        steps.push_back({pose->stamp, nullptr, &*pose, {}, {}, 0});
      ++pose;
    }
    const bool both = pose != instants.end() && pose->stamp == placed[i].stamp;
    steps.push_back({placed[i].stamp, &placed[i], both ? &*pose : nullptr, {}, {}, 0});
    if (both) ++pose;
  }
  std::vector<TruthObject> out;
  if (placed.size() < 2) return out;
  smooth(steps);
  std::optional<double> heading;
  std::vector<std::size_t> without;  // heading, before the first course
  for (const Step& step : steps) {
    const Vector2 place(step.filtered.x[0], step.filtered.y[0]);
    const Vector2 velocity(step.filtered.x[1], step.filtered.y[1]);
    if (velocity.norm() > kMoves) heading = std::atan2(velocity.y(), velocity.x());
    if (step.pose == nullptr) continue;
    TruthObject o;
    o.frame = step.pose->frame, o.t = step.pose->stamp - first;
    o.id = vehicle.id, o.type = vehicle.type;
    o.length = vehicle.length, o.width = vehicle.width, o.height = vehicle.height;
    o.vx = velocity.x(), o.vy = velocity.y();
    o.position = Vector3(place.x(), place.y(), step.pose->T_world_ego.translation().z());
    if (heading) o.yaw = *heading;
    if (!heading) without.push_back(out.size());
    out.push_back(o);
  }
  const auto known = std::find_if(steps.begin(), steps.end(), [](const Step& step) {
    return std::hypot(step.filtered.x[1], step.filtered.y[1]) > kMoves;
  });
  if (known != steps.end())
    for (const std::size_t i : without)
      out[i].yaw = std::atan2(known->filtered.y[1], known->filtered.x[1]);
  for (TruthObject& o : out) o.position.head<2>() -= rotate2(o.yaw, vehicle.antenna);
  return out;
}

}  // namespace perception
