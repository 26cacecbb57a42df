#include "libperception/odometry/LidarOdometry.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "libperception/lidar/EgoPoints.h"

namespace perception {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr double kCell = 1.0;        ///< [m] of the map: a car's side spans four
constexpr double kMapPoints = 0.25;  ///< [m] spacing of the points that enter the map
/// [m] spacing of those that are registered: of the ground, below kLow, and of what stands on it,
/// which alone shows how far the vehicle went.
constexpr double kGroundPoints = 1, kStandingPoints = 0.25, kLow = 0.3;
constexpr double kNear = 3, kFar = 80;  ///< [m] range of both: beyond the own vehicle
constexpr double kMapRange = 100;       ///< [m] of the map about the vehicle
constexpr int kSteps = 20;              ///< Gauss-Newton at most
constexpr double kEnough = 1e-4;        ///< [m, rad] smaller steps end it
/// Scale of the kernel of Geman and McClure, w = 1 / (1 + d^2 / kScale)^2: a point off by .3 m, on
/// a moving object, has a hundredth of the weight of one on its surface.
constexpr double kScale = 1;
constexpr double kLeastMatched = 50;  ///< sum of weights; fewer points hold no six unknowns
constexpr double kHold = 0.5;         ///< [s] a motion this old is no prediction
constexpr int kSettled = 4;           ///< steps after which the motion is sure
/// [m/s^2], [rad/s^2] changes of motion that a vehicle makes (braking hard; entering a bend).
constexpr double kAcceleration = 8, kTurn = 1;
/// Share of its information that a surface has along z: less and it stands.
constexpr double kUpright = 0.5;
/// A first speed must fit this much better than standing still.
constexpr double kBetter = 1.05;
/// [m/s] speeds tried for the first step, where no motion is known.
constexpr double kSlowest = -10, kFastest = 45, kSpeedStep = 2.5;

std::vector<Vector3> placesOf(const SensorFrame& frame) {
  PointParams all;
  all.range_min = kNear, all.range_max = kFar;
  const EgoPoints points = usablePoints(frame, all);
  std::vector<Vector3> out;
  out.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    out.emplace_back(static_cast<double>(points.x[i]), static_cast<double>(points.y[i]),
                     static_cast<double>(points.z[i]));
  return out;
}

std::vector<Vector3> moved(const std::vector<Vector3>& points, const Pose3& T) {
  std::vector<Vector3> out;
  out.reserve(points.size());
  for (const Vector3& p : points) out.push_back(T * p);
  return out;
}

/// The part `share` of a motion.
Pose3 scaled(const Pose3& motion, double share) {
  const Eigen::AngleAxisd turn(motion.linear());
  Pose3 out = Pose3::Identity();
  out.translation() = share * motion.translation();
  out.linear() = Eigen::AngleAxisd(share * turn.angle(), turn.axis()).toRotationMatrix();
  return out;
}

Eigen::Matrix3d cross(const Vector3& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// The points to register, of dense ones.
std::vector<Vector3> chosen(const std::vector<Vector3>& dense) {
  std::vector<Vector3> ground, standing;
  for (const Vector3& p : dense) (p.z() < kLow ? ground : standing).push_back(p);
  std::vector<Vector3> out = thinned(ground, kGroundPoints);
  const std::vector<Vector3> above = thinned(standing, kStandingPoints);
  out.insert(out.end(), above.begin(), above.end());
  return out;
}

struct Normal {
  Matrix6 H = Matrix6::Zero();
  Vector6 g = Vector6::Zero();
  double matched = 0;   ///< sum of weights
  double standing = 0;  ///< of those on upright surfaces
};

/// Of the point's own cell and its six neighbors the one it fits best.
void addPoint(const VoxelMap& map, const Vector3& point, const Vector3& center, Normal& sum) {
  static constexpr int kNeighbors[7][3] = {{0, 0, 0},  {1, 0, 0}, {-1, 0, 0}, {0, 1, 0},
                                           {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  const VoxelMap::Surface* best = nullptr;
  double best_distance = 1e9;  // between point and mean [m^2]
  for (const auto& n : kNeighbors) {
    const auto* surface = map.at(point, n[0], n[1], n[2]);
    if (surface == nullptr) continue;
    const double distance = (surface->mean - point).squaredNorm();
    if (distance < best_distance) best = surface, best_distance = distance;
  }
  if (best == nullptr) return;
  const Vector3 e = best->mean - point, Me = best->information * e;
  const double w = 1 / ((1 + e.dot(Me) / kScale) * (1 + e.dot(Me) / kScale));
  Eigen::Matrix<double, 3, 6> J;
  J.leftCols<3>() = -cross(point - center);
  J.rightCols<3>() = Eigen::Matrix3d::Identity();
  sum.H += w * J.transpose() * best->information * J;
  sum.g += w * J.transpose() * Me;
  sum.matched += w;
  if (best->information(2, 2) < kUpright * best->information.trace()) sum.standing += w;
}

}  // namespace

LidarOdometry::LidarOdometry() : map_(kCell) {}

LidarOdometry::Fit LidarOdometry::registered(const std::vector<Vector3>& points, Pose3 T,
                                             int steps) const {
  Fit fit;
  for (int i = 0; i < steps; ++i) {
    Normal sum;
    const Vector3 center = T.translation();
    for (const Vector3& p : points) addPoint(map_, T * p, center, sum);
    fit.standing = sum.standing;
    fit.good = sum.matched >= kLeastMatched;
    if (!fit.good) break;
    // What no surface holds (a tunnel, an empty plain) stays as predicted.
    const Matrix6 damped = sum.H + Matrix6::Identity();
    const Vector6 step = damped.ldlt().solve(sum.g);
    const double angle = step.head<3>().norm();
    if (angle > 0)
      T.linear() = Eigen::AngleAxisd(angle, step.head<3>() / angle).toRotationMatrix() * T.linear();
    T.translation() += step.tail<3>();
    if (step.norm() < kEnough) break;
  }
  fit.T_world_ego = T;
  return fit;
}

Pose3 LidarOdometry::start(const std::vector<Vector3>& points, double dt) const {
  Fit best = registered(points, T_world_ego_, 5);
  best.standing *= kBetter;
  for (double speed = kSlowest; speed <= kFastest; speed += kSpeedStep) {
    const Fit fit = registered(points, T_world_ego_ * makePose(speed * dt, 0, 0, 0), 5);
    if (fit.good && fit.standing > best.standing) best = fit;
  }
  return best.good ? best.T_world_ego : T_world_ego_;
}

std::optional<Pose3> LidarOdometry::update(const SensorFrame& frame) {
  if (!std::holds_alternative<LidarCloud>(frame.data)) return std::nullopt;
  if (stamp_ && frame.stamp <= *stamp_) return std::nullopt;
  const std::vector<Vector3> dense = thinned(placesOf(frame), kMapPoints);
  if (stamp_) {
    const std::vector<Vector3> points = chosen(dense);
    const double dt = frame.stamp - *stamp_;
    const bool known = step_ > 0 && dt < kHold;
    const Pose3 predicted = known ? T_world_ego_ * scaled(motion_, dt / step_) : start(points, dt);
    Fit fit = registered(points, predicted, kSteps);
    const Pose3 off = predicted.inverse() * fit.T_world_ego;
    // More than a vehicle does: the scan lies on a wrong surface.
    const bool leapt = steps_ > kSettled &&
                       (off.translation().norm() > kAcceleration * dt * std::max(dt, 0.1) + 0.3 ||
                        std::abs(Eigen::AngleAxisd(off.linear()).angle()) > kTurn * dt + 0.02);
    if (!fit.good || leapt) fit.T_world_ego = predicted, ++lost_;
    motion_ = T_world_ego_.inverse() * fit.T_world_ego;
    step_ = dt;
    steps_ = known ? steps_ + 1 : 1;
    T_world_ego_ = fit.T_world_ego;
  }
  stamp_ = frame.stamp;
  map_.keepNear(T_world_ego_.translation(), kMapRange);
  map_.insert(moved(dense, T_world_ego_));
  return T_world_ego_;
}

}  // namespace perception
