#include "libperception/doctor/motion/MotionCheck.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "libperception/core/PoseSteps.h"
#include "libperception/core/math/Median.h"
#include "libperception/doctor/motion/Course.h"
#include "libperception/doctor/motion/MotionFit.h"

namespace perception {
namespace {

using Eigen::VectorXd;

/// Parameters of the fit; kScale: of the way by odometry, which slips.
enum Parameter { kYaw, kPitch, kRoll, kAhead, kLeft, kClock, kScale, kParameters };

constexpr double kMotionWindow = 0.4;  ///< [s] of a motion that is compared: several scans
constexpr double kLongestStep = 1.0;   ///< [s] between the scans of one motion
constexpr double kClockRange = 0.5;    ///< [s] clock offsets searched, on both sides
constexpr double kClockStep = 0.02;    ///< [s]
constexpr double kMovingSpeed = 1;     ///< [m/s] slower, the direction of travel is noise
/// Largest standard deviations of what is observed: half of 1 deg, .1 m, 20 ms; and what a
/// mounting measured with a tape, or a stamp at the wrong end of an exposure, is off by.
constexpr double kAngleEnough = radians(0.5), kPlaceEnough = 0.05, kClockEnough = 0.01;
constexpr double kAngleWrong = radians(1), kPlaceWrong = 0.1, kClockWrong = 0.02;
/// [rad, m, s, 1] standard deviations before the log is seen (assumed).
constexpr std::array<double, kParameters> kPrior{radians(15), radians(15), radians(15), 1,
                                                 1,           0.3,         0.05};

/// A motion that the sensor saw.
struct Seen {
  Stamp from, to;
  Pose3 motion = Pose3::Identity();
};

/// Clock offset at which the yaw and (if known) the length of the motions agree best with the
/// poses': the largest profile likelihood of both, noise and mean difference unknown.
double bestClock(const std::vector<Seen>& seen, const Course& course, bool lengths) {
  double best = 0, least = 1e300;
  for (double clock = -kClockRange; clock <= kClockRange; clock += kClockStep) {
    double n = 0, sum[2] = {0, 0}, squares[2] = {0, 0};
    for (const Seen& s : seen) {
      const auto B = course.motion(s.from, s.to, -clock);
      if (!B) continue;
      const double r[2] = {turnOf(s.motion).z() - turnOf(*B).z(),
                           lengths ? s.motion.translation().norm() - B->translation().norm() : 0};
      for (int i = 0; i < 2; ++i) sum[i] += r[i], squares[i] += r[i] * r[i];
      ++n;
    }
    if (n < 0.8 * static_cast<double>(seen.size()) || n < 1) continue;
    // [rad^2, m^2] what odometry resolves: less is luck.
    const double floor[2] = {1e-6, 1e-4};
    double cost = 0;
    for (int i = 0; i < 2; ++i)
      cost += std::log(squares[i] / n - sum[i] * sum[i] / (n * n) + floor[i]);
    if (cost < least) least = cost, best = clock;
  }
  return best;
}

/// How far an antenna went.
struct GnssWay {
  Stamp from, to;
  Vector2 step = Vector2::Zero();  ///< [m] east, north
};

/// The same by the poses, in their world.
std::optional<Vector2> wayOf(const GnssWay& way, const Vector2& antenna, const Course& course,
                             double later) {
  const auto a = course.at(way.from, later), b = course.at(way.to, later);
  if (!a || !b) return std::nullopt;
  const Vector3 place(antenna.x(), antenna.y(), 0);
  return Vector2((*b * place - *a * place).head<2>());
}

/// Clock offset and turn from the poses' world to east and north with the least squares.
std::pair<double, double> bestGnssClock(const std::vector<GnssWay>& ways, const Vector2& antenna,
                                        const Course& course) {
  std::pair<double, double> best{0, 0};
  double least = 1e300;
  for (double clock = -kClockRange; clock <= kClockRange; clock += kClockStep) {
    double n = 0, along = 0, across = 0, squares = 0;
    for (const GnssWay& w : ways) {
      const auto d = wayOf(w, antenna, course, -clock);
      if (!d) continue;
      along += d->dot(w.step), across += d->x() * w.step.y() - d->y() * w.step.x();
      squares += d->squaredNorm() + w.step.squaredNorm(), ++n;
    }
    if (n < 0.8 * static_cast<double>(ways.size()) || n < 1) continue;
    const double cost = (squares - 2 * std::hypot(along, across)) / n;
    if (cost < least) least = cost, best = {clock, std::atan2(across, along)};
  }
  return best;
}

FitProblem problemOf(std::size_t items, Eigen::Index rows, double clock) {
  FitProblem p;
  p.items = items, p.rows = rows;
  p.start = p.mean = VectorXd::Zero(kParameters);
  p.start[kClock] = clock;
  p.sigma = Eigen::Map<const VectorXd>(kPrior.data(), kParameters);
  p.step = VectorXd::Constant(kParameters, 1e-4);
  p.step[kClock] = 0.01;
  p.least = VectorXd::Constant(rows, 1e-4);
  return p;
}

/// [rad] Median angle between the poses' way and their own ground plane: a vehicle does not fly,
/// but poses with a pitch of 0 on a hill do.
double climbOf(const std::vector<Seen>& seen, const Course& course) {
  std::vector<double> climbs;
  for (const Seen& s : seen)
    if (const auto B = course.motion(s.from, s.to, 0))
      climbs.push_back(std::atan2(B->translation().z(), B->translation().head<2>().norm()));
  return climbs.empty() ? 0 : medianOf(std::move(climbs));
}

std::optional<MotionCheck> checkOf(const FitProblem& problem) {
  const auto fit = fitRobustly(problem);
  if (!fit) return std::nullopt;
  const auto value = [&fit](Parameter p, double enough, double wrong) {
    return MotionCheck::Value{fit->value[p], fit->sigma[p], enough, wrong};
  };
  MotionCheck check;
  check.yaw = value(kYaw, kAngleEnough, kAngleWrong);
  check.pitch = value(kPitch, kAngleEnough, kAngleWrong);
  check.roll = value(kRoll, kAngleEnough, kAngleWrong);
  check.ahead = value(kAhead, kPlaceEnough, kPlaceWrong);
  check.left = value(kLeft, kPlaceEnough, kPlaceWrong);
  check.clock = value(kClock, kClockEnough, kClockWrong);
  check.used = fit->used;
  return check;
}

Eigen::Matrix3d rotationOf(const VectorXd& x) {
  return makePose(0, 0, 0, x[kYaw], x[kPitch], x[kRoll]).linear();
}

}  // namespace

bool MotionCheck::Value::isWrong() const {
  return observable() && std::abs(error) > std::max(wrong, 3 * sigma);
}

std::optional<MotionCheck> checkLidarMotion(const std::vector<EgoState>& scans,
                                            const Pose3& T_ego_sensor,
                                            const std::vector<EgoState>& poses) {
  const Course course(poses);
  std::vector<Seen> seen;
  std::size_t steps = 0, j = 0;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    while (j < scans.size() && scans[j].stamp - scans[i].stamp < kMotionWindow) ++j;
    if (j == scans.size()) break;
    const double dt = scans[j].stamp - scans[i].stamp;
    const Seen s{scans[i].stamp, scans[j].stamp,
                 scans[i].T_world_ego.inverse() * scans[j].T_world_ego};
    if (dt > kLongestStep || s.motion.translation().norm() < kMovingSpeed * dt) continue;
    seen.push_back(s), steps += j - i;
  }
  if (seen.empty()) return std::nullopt;
  FitProblem p = problemOf(seen.size(), 6, bestClock(seen, course, true));
  p.shared = static_cast<double>(steps) / static_cast<double>(seen.size());
  const Vector3 place = T_ego_sensor.translation();
  p.residuals = [&](std::size_t k, const VectorXd& x, VectorXd& r) {
    const auto B = course.motion(seen[k].from, seen[k].to, -x[kClock]);
    if (!B) return false;
    const Pose3& A = seen[k].motion;
    // X takes points of the true vehicle frame to that of the log's mounting: A X = X B.
    const Eigen::Matrix3d R = rotationOf(x);
    const Vector3 t = place - R * (place - Vector3(x[kAhead], x[kLeft], 0));
    r.head<3>() = turnOf(A) - R * turnOf(*B);
    r.tail<3>() = A.translation() - (1 + x[kScale]) * (R * B->translation() + t - A.linear() * t);
    return true;
  };
  auto check = checkOf(p);
  if (!check) return std::nullopt;
  check->pitch.sigma = std::hypot(check->pitch.sigma, climbOf(seen, course));
  return check;
}

std::optional<MotionCheck> checkRadarMotion(const std::vector<SensorVelocity>& scans,
                                            const Pose3& T_ego_sensor,
                                            const std::vector<EgoState>& poses) {
  constexpr double kHalf = 0.1;  // [s] of the poses' motion on either side of a scan
  const Course course(poses);
  std::vector<SensorVelocity> moving;
  for (const SensorVelocity& s : scans)
    if (s.velocity.norm() > kMovingSpeed) moving.push_back(s);
  if (moving.empty()) return std::nullopt;
  const Vector2 place = T_ego_sensor.translation().head<2>();
  const Matrix2 R_ego_sensor = Eigen::Rotation2Dd(yawOf(T_ego_sensor)).toRotationMatrix();
  FitProblem p = problemOf(moving.size(), 2, 0);
  p.residuals = [&](std::size_t k, const VectorXd& x, VectorXd& r) {
    const auto center = course.at(moving[k].stamp, -x[kClock]);
    const auto before = course.at(moving[k].stamp, -x[kClock] - kHalf);
    const auto after = course.at(moving[k].stamp, -x[kClock] + kHalf);
    if (!center || !before || !after) return false;
    const Vector3 step =
        center->linear().transpose() * (after->translation() - before->translation());
    const double turn = turnOf(before->inverse() * *after).z() / (2 * kHalf);
    const Vector2 lever = place - Vector2(x[kAhead], x[kLeft]);
    const Vector2 v = step.head<2>() / (2 * kHalf) + turn * Vector2(-lever.y(), lever.x());
    const Vector2 seen_v = (1 + x[kScale]) * (R_ego_sensor.transpose() * rotate2(x[kYaw], v));
    const Matrix2 U = moving[k].information.llt().matrixU();
    r = U * (moving[k].velocity - seen_v);
    return true;
  };
  return checkOf(p);
}

std::optional<MotionCheck> checkImageMotion(const std::vector<CameraMotion>& motions,
                                            const Pose3& T_ego_sensor,
                                            const std::vector<EgoState>& poses) {
  const Course course(poses);
  const Eigen::Matrix3d R_ego_sensor = T_ego_sensor.linear();
  std::vector<Seen> seen;  // length 1
  for (const CameraMotion& m : motions) {
    const auto way = course.motion(m.from, m.to, 0);
    if (!way || way->translation().norm() < kMovingSpeed * (m.to - m.from)) continue;
    Seen s{m.from, m.to};
    s.motion.linear() = R_ego_sensor * m.turn * R_ego_sensor.transpose();
    s.motion.translation() = R_ego_sensor * m.travel;
    seen.push_back(s);
  }
  if (seen.empty()) return std::nullopt;
  FitProblem p = problemOf(seen.size(), 5, bestClock(seen, course, false));
  const Vector3 place = T_ego_sensor.translation();
  p.residuals = [&](std::size_t k, const VectorXd& x, VectorXd& r) {
    const auto B = course.motion(seen[k].from, seen[k].to, -x[kClock]);
    if (!B) return false;
    const Eigen::Matrix3d R = rotationOf(x);
    const Vector3 way = R * (B->translation() + B->linear() * place - place);
    r.head<3>() = turnOf(seen[k].motion) - R * turnOf(*B);
    r.tail<2>() = (seen[k].motion.translation() - way.normalized()).tail<2>();
    return true;
  };
  auto check = checkOf(p);
  if (!check) return std::nullopt;
  check->ahead = check->left = MotionCheck::Value{0, 1, 0, 0};
  check->pitch.sigma = std::hypot(check->pitch.sigma, climbOf(seen, course));
  return check;
}

std::optional<MotionCheck> checkGnssMotion(const std::vector<AntennaPlace>& fixes,
                                           const Vector2& antenna,
                                           const std::vector<EgoState>& poses) {
  constexpr double kWay = 2, kWayLongest = 5;  // [s] of a difference of two fixes
  const Course course(poses);
  std::vector<GnssWay> ways;
  std::size_t steps = 0, j = 0;
  for (std::size_t i = 0; i < fixes.size(); ++i) {
    while (j < fixes.size() && fixes[j].stamp - fixes[i].stamp < kWay) ++j;
    if (j == fixes.size()) break;
    const double dt = fixes[j].stamp - fixes[i].stamp;
    const GnssWay way{fixes[i].stamp, fixes[j].stamp, fixes[j].place - fixes[i].place};
    if (dt > kWayLongest || way.step.norm() < kMovingSpeed * dt) continue;
    ways.push_back(way), steps += j - i;
  }
  if (ways.empty()) return std::nullopt;
  const auto [clock, turn] = bestGnssClock(ways, antenna, course);
  FitProblem p = problemOf(ways.size(), 2, clock);
  p.start[kYaw] = p.mean[kYaw] = turn;
  p.sigma[kYaw] = kPi;
  p.shared = static_cast<double>(steps) / static_cast<double>(ways.size());
  p.residuals = [&](std::size_t k, const VectorXd& x, VectorXd& r) {
    const auto d = wayOf(ways[k], antenna - Vector2(x[kAhead], x[kLeft]), course, -x[kClock]);
    if (!d) return false;
    r = ways[k].step - (1 + x[kScale]) * rotate2(x[kYaw], *d);
    return true;
  };
  auto check = checkOf(p);
  if (!check) return std::nullopt;
  check->yaw = check->pitch = check->roll = MotionCheck::Value{0, 1, 0, 0};
  return check;
}

Pose3 correctedMounting(const MotionCheck& check, const Pose3& T_ego_sensor) {
  const auto error = [](const MotionCheck::Value& v) { return v.isWrong() ? v.error : 0; };
  const Pose3 turned = makePose(0, 0, 0, error(check.yaw), error(check.pitch), error(check.roll));
  Pose3 out = T_ego_sensor;
  out.linear() = turned.linear().transpose() * T_ego_sensor.linear();
  out.translation() -= Vector3(error(check.ahead), error(check.left), 0);
  return out;
}

}  // namespace perception
