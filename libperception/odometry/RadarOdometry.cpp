#include "libperception/odometry/RadarOdometry.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace perception {
namespace {

// All assumed: what vehicles do, and what radars of vehicles measure.
constexpr double kRateSigma =
    0.15;                      ///< [m/s] of a standing target's rate, spread of the target in it
constexpr double kGate = 0.5;  ///< [m/s] within which a motion explains a target
constexpr double kSlowestRadar = -10, kFastestRadar = 70,
                 kRadarSpeedStep = 0.25;  ///< [m/s] of the search
constexpr double kRadarAcceleration = 8,
                 kRadarTurn = 1;    ///< [m/s^2], [rad/s^2] as standard deviations
constexpr double kFirstTurn = 0.3;  ///< [rad/s] before anything is known
constexpr double kSlip = 0.02;      ///< of the speed: sideways motion of the ego origin (rear axle)
constexpr double kLeastSlip = 0.02;  ///< [m/s] the same of a standing vehicle
constexpr std::size_t kLeastTargets = 3;
constexpr double kLeastShare = 0.2;  ///< of the targets, to be what stands
constexpr double kOtherGroup = 1.5;  ///< a group so much larger than the predicted one counts ...
constexpr int kLongestUnexplained = 5;  ///< ... when it is for so many instants
constexpr int kRadarSteps = 8;

std::size_t explained(const std::vector<Vector3>& rows, const std::vector<double>& rates,
                      const Vector3& motion) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < rows.size(); ++i)
    n += std::abs(rates[i] - rows[i].dot(motion)) < kGate;
  return n;
}

}  // namespace

/// r' = -u . (v + omega x p): u the unit vector to the target, p the place of the radar, both in
/// the vehicle frame.
void RadarOdometry::addRows(const SensorFrame& frame, std::vector<Row>& rows) {
  const auto* radar = std::get_if<RadarReturns>(&frame.data);
  if (radar == nullptr) return;
  const Vector3 p = frame.T_ego_sensor.translation();
  for (const RadarReturn& r : radar->returns) {
    if (!r.has_rate || !std::isfinite(r.range_rate + r.bearing)) continue;
    const double up = r.elevation.value_or(0);
    const Vector3 u =
        frame.T_ego_sensor.linear() * Vector3(std::cos(up) * std::cos(r.bearing),
                                              std::cos(up) * std::sin(r.bearing), std::sin(up));
    rows.push_back({Vector3(-u.x(), -u.y(), u.x() * p.y() - u.y() * p.x()), r.range_rate});
  }
}

/// The speed straight ahead that explains most targets; the slowest of equal ones.
std::optional<Vector3> RadarOdometry::searched(const std::vector<Row>& rows) {
  std::vector<Vector3> directions;
  std::vector<double> rates;
  for (const Row& r : rows) directions.push_back(r.row), rates.push_back(r.rate);
  Vector3 best = Vector3::Zero();
  std::size_t most = explained(directions, rates, best);
  for (double speed = kSlowestRadar; speed <= kFastestRadar; speed += kRadarSpeedStep) {
    const std::size_t n = explained(directions, rates, Vector3(speed, 0, 0));
    if (n > most || (n == most && std::abs(speed) < std::abs(best.x())))
      most = n, best = Vector3(speed, 0, 0);
  }
  const double share = kLeastShare * static_cast<double>(rows.size());
  if (most < kLeastTargets || static_cast<double>(most) < share) return std::nullopt;
  return best;
}

void RadarOdometry::predict(double dt) {
  Eigen::Matrix3d& P = motion_.covariance;
  P(0, 0) += kRadarAcceleration * dt * kRadarAcceleration * dt;
  P(2, 2) += kRadarTurn * dt * kRadarTurn * dt;
  // Sideways motion is what the wheels allow, whatever it was.
  const double slip = kSlip * std::abs(motion_.mean.x()) + kLeastSlip;
  P.row(1).setZero(), P.col(1).setZero();
  P(1, 1) = slip * slip;
  motion_.mean.y() = 0;
}

/// Maximum a posteriori by iteratively reweighted least squares, weights of Geman and McClure.
bool RadarOdometry::correct(const std::vector<Row>& rows) {
  const Eigen::Matrix3d prior = motion_.covariance.inverse();
  Vector3 x = motion_.mean;
  Eigen::Matrix3d information = prior;
  std::size_t n = 0;
  for (int step = 0; step < kRadarSteps; ++step) {
    information = prior;
    Vector3 sum = prior * motion_.mean;
    n = 0;
    for (const Row& r : rows) {
      const double e = (r.rate - r.row.dot(x)) / kRateSigma;
      const double spread = step == 0 ? std::sqrt(r.row.dot(motion_.covariance * r.row)) : 0;
      const double kernel = 1 + e * e / (4 + spread * spread / (kRateSigma * kRateSigma));
      const double weight = 1 / (kernel * kernel * kRateSigma * kRateSigma);
      information += weight * r.row * r.row.transpose();
      sum += weight * r.rate * r.row;
      n += std::abs(e) * kRateSigma < kGate;
    }
    x = information.ldlt().solve(sum);
  }
  const double share = kLeastShare * static_cast<double>(rows.size());
  if (n < kLeastTargets || static_cast<double>(n) < share) return false;
  motion_.mean = x;
  motion_.covariance = information.inverse();
  motion_.standing = n;
  return true;
}

std::optional<EgoState> RadarOdometry::update(const std::vector<const SensorFrame*>& frames) {
  std::vector<Row> rows;
  for (const SensorFrame* frame : frames) addRows(*frame, rows);
  if (rows.empty() || (stamp_ && frames.front()->stamp <= *stamp_)) return std::nullopt;
  const Stamp stamp = frames.front()->stamp;
  const double dt = stamp_ ? stamp - *stamp_ : 0;
  const Vector3 before = motion_.mean;
  if (known_) predict(dt);
  const auto found = searched(rows);
  std::size_t here = 0;
  for (const Row& r : rows) here += std::abs(r.rate - r.row.dot(motion_.mean)) < kGate;
  std::size_t there = 0;
  for (const Row& r : rows) there += found && std::abs(r.rate - r.row.dot(*found)) < kGate;
  const bool other = static_cast<double>(there) >
                     kOtherGroup * static_cast<double>(std::max<std::size_t>(here, 1));
  unexplained_ = known_ && other ? unexplained_ + 1 : 0;
  if ((!known_ || unexplained_ > kLongestUnexplained) && found) {
    motion_.mean = *found;
    motion_.covariance = Vector3(1, 1, kFirstTurn * kFirstTurn).asDiagonal();
    predict(0);
    motion_.mean.x() = found->x();
    known_ = true;
    unexplained_ = 0;
  }
  if (!known_) return std::nullopt;
  if (!correct(rows)) ++lost_, motion_.standing = 0;
  const bool first = !stamp_;
  stamp_ = stamp;
  if (!first) {
    const Vector3 mean = 0.5 * (before + motion_.mean);
    const double turn = mean.z() * dt;
    const Vector2 step = rotate2(turn / 2, dt * mean.head<2>());
    T_world_ego_ = T_world_ego_ * makePose(step.x(), step.y(), 0, turn);
  }
  EgoState state;
  state.stamp = stamp;
  state.T_world_ego = T_world_ego_;
  state.velocity =
      (T_world_ego_.linear() * Vector3(motion_.mean.x(), motion_.mean.y(), 0)).head<2>();
  state.yaw_rate = motion_.mean.z();
  state.uncertainty.sigma_xy = dt * std::sqrt(motion_.covariance(0, 0) + motion_.covariance(1, 1));
  state.uncertainty.sigma_yaw = dt * std::sqrt(motion_.covariance(2, 2));
  return state;
}

}  // namespace perception
