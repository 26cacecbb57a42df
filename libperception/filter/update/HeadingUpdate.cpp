#include "libperception/filter/update/HeadingUpdate.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Angle.h"
#include "libperception/core/math/KalmanUpdate.h"
#include "libperception/core/math/LogMath.h"
#include "libperception/filter/state/ClassFilterMotion.h"

namespace perception {
namespace {

/// Standard deviations from which a speed is beyond doubt, and with it the axis along which the
/// object moves.
constexpr double kSureSpeed = 3;

/// Clusters show the wrong one of their sides more often than image boxes a wrong heading, and do
/// so again in the next scan (assumed).
constexpr double kStrayClusterAxes = 0.2, kDenied = -3;

/// [m^2] Variance of the place of a person (assumed).
constexpr double kPlaceVariance = 0.5 * 0.5;

bool movesAlongItsAxis(const ClassFilter& f, const FilterParams& p) {
  return std::abs(f.x[2]) > std::max(p.orient_min_speed, kSureSpeed * std::sqrt(f.P(2, 2)));
}

/// The shape of a car tells its front where its box lies along its axis.
void useShape(const PartialBox& sides, ClassFilter& f) {
  constexpr double kAligned = 0.9;  // cosine (assumed)
  const double along = std::cos(sides.yaw - f.x[3]);
  if (sides.front_log_odds == 0 || std::abs(along) < kAligned) return;
  seeShape(along > 0 ? sides.front_log_odds : -sides.front_log_odds, f.heading);
}

/// Whether the opposite of theta, which no detection has told, is rather the front: by a clear
/// speed, else by the shape and the way so far.
bool facesBack(const ClassFilter& f, const FilterParams& p) {
  constexpr double kBack = 0.38;  // log-odds of -0.5, as for detections
  if (std::abs(f.x[2]) > p.orient_min_speed && movesSurely(f)) return f.x[2] < 0;
  return f.heading.views > 0 && f.heading.frontProbability() < kBack;
}

void reverseBodyIfAsked(HeadingMode mode, Track& track) {
  if (asksForReversal(track.body_heading_bit, 0, 1, mode)) {
    track.body_heading->mean += kPi;
    track.body_heading_bit = track.body_heading_bit.reversed();
  }
  track.body_heading->mean = wrapAngle(track.body_heading->mean);
}

/// The filter of the likeliest class that moves and has no heading in its state; null: none.
const ClassFilter* walkerOf(const FilterModel& model, const Track& track) {
  const ClassFilter* walker = nullptr;
  double best = kMinusInfinity;
  for (ClassId j = 0; j < model.classes.size(); ++j) {
    const MotionModel& motion = *model.classes[j].motion;
    const auto i = static_cast<std::size_t>(j);
    if (!motion.moves || motion.has_heading || !track.live(j) || track.log_class[i] <= best)
      continue;
    best = track.log_class[i];
    walker = &track.bank[track.filterOf(i)];
  }
  return walker;
}

}  // namespace

void useHeading(const MeasuredHeading& seen, const FilterParams& params, ClassFilter& f,
                bool may_mirror) {
  const HeadingMode mode = params.heading;
  const double sigma2 = seen.sigma * seen.sigma;
  if (!f.oriented) {
    const bool wide = mode == HeadingMode::kWide;
    orientAlong(seen.yaw, wide ? headingResidual(seen, seen.yaw, mode).variance : sigma2, f);
    f.heading = firstFrontBack(seen);
    return;
  }
  const HeadingResidual r = headingResidual(seen, f.x[3], mode);
  if (may_mirror && mode == HeadingMode::kSplit) {
    f.heading.axis_log_odds = nextAxisLogOdds(f.heading, seen, f.x[3], f.P(3, 3));
    if (f.heading.axis_log_odds < 0 && !movesAlongItsAxis(f, params)) {
      reorient(seen.yaw, sigma2, f);
      f.heading = firstFrontBack(seen);
      return;
    }
  }
  if (r.y * r.y >= kYawGate * (f.P(3, 3) + r.variance)) return;
  updateYaw(r.y, r.variance, f);
  f.heading = nextFrontBack(f.heading, r.same, seen);
}

bool findHeading(const Measurement& m, const std::optional<BirthState>& birth,
                 const FilterParams& p, ClassFilter& f) {
  const bool was_oriented = f.oriented;
  const double box_extra = p.shape_yaw_sigma * p.shape_yaw_sigma;
  if (!f.oriented) {
    const double v = f.x.tail<2>().norm();
    const double sigma_v = std::sqrt(0.5 * (f.P(2, 2) + f.P(3, 3)));
    if (v >= p.orient_min_speed && sigma_v <= p.orient_max_sigma * v) {
      orientByVelocity(f);
    } else if (birth && birth->yaw) {
      orientByAxis(birth->yaw->mean, birth->yaw->variance + box_extra, f);
    }
  } else if (birth && birth->yaw) {  // the box's long axis, front and back alike
    const double y = wrapAxis(birth->yaw->mean - f.x[3]);
    const double variance = birth->yaw->variance + box_extra;
    if (y * y < kYawGate * (f.P(3, 3) + variance)) updateYaw(y, variance, f);
  }
  if (m.heading) useHeading(*m.heading, p, f, !m.sides);
  if (!f.oriented) return false;
  if (m.sides) useShape(*m.sides, f);
  const bool back = f.heading.measured() ? asksForReversal(f.heading, f.x[2], f.P(2, 2), p.heading)
                                         : facesBack(f, p);
  if (back) reverse(f);
  return !was_oriented;
}

void takeSizeOfClass(const ObjectClass& c, const SensorState& sensor, ClassFilter& f) {
  const Vector2 sight = f.x.head<2>() - sensor.T_world_sensor.translation().head<2>();
  if (sight.squaredNorm() <= 0) return;
  const double radius = 0.25 * (f.extent.length + f.extent.width);
  f.extent = {c.length, c.width, c.length_sigma * c.length_sigma, c.width_sigma * c.width_sigma};
  const Vector2 axis(std::cos(f.x[3]), std::sin(f.x[3]));
  const Vector2 along = axis.dot(sight.normalized()) * axis;
  const auto move = [&](Vector4& x, Matrix4& P) {
    x.head<2>() += (0.5 * f.extent.length - radius) * along;
    P.topLeftCorner<2, 2>() += 0.25 * f.extent.var_length * along * along.transpose();
  };
  move(f.x, f.P);
  for (ModeFilter& mode : f.modes) move(mode.x, mode.P);
}

bool boxDeniesAxis(const Measurement& m, const std::optional<BirthState>& birth,
                   const FilterParams& p, ClassFilter& f) {
  if (!f.oriented || m.heading || !m.sides || !birth || !birth->yaw) return false;
  f.heading.driven = f.heading.driven || movesAlongItsAxis(f, p);
  if (f.heading.driven) return false;
  MeasuredHeading seen;
  seen.yaw = birth->yaw->mean;
  seen.sigma = std::hypot(std::sqrt(birth->yaw->variance), p.shape_yaw_sigma);
  f.heading.axis_log_odds = nextAxisLogOdds(f.heading, seen, f.x[3], f.P(3, 3), kStrayClusterAxes);
  return f.heading.axis_log_odds < kDenied;
}

void updateBodyHeading(const MeasuredHeading& seen, const FilterParams& params, Track& track) {
  const HeadingMode mode = params.heading;
  if (!track.body_heading) {
    track.body_heading = {seen.yaw, seen.sigma * seen.sigma};
    track.body_heading_bit = firstFrontBack(seen);
    return;
  }
  const HeadingResidual r = headingResidual(seen, track.body_heading->mean, mode);
  if (r.y * r.y < kYawGate * (track.body_heading->variance + r.variance)) {
    scalarUpdate({track.body_heading->mean + r.y, r.variance}, *track.body_heading);
  } else {  // people turn on the spot
    track.body_heading = {seen.yaw, seen.sigma * seen.sigma};
    track.body_heading_bit.walk = 0;
    track.walked_from.reset();
  }
  track.body_heading_bit = nextFrontBack(track.body_heading_bit, r.same, seen);
  reverseBodyIfAsked(mode, track);
}

bool isOfImagesAlone(const Track& track) {
  bool by_camera = false;
  const auto& rows = modalities();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (track.last_hit[i].ns == 0) continue;
    if (rows[i].letter != Modality::kCamera) return false;
    by_camera = true;
  }
  return by_camera;
}

void faceTheWay(const FilterModel& model, Track& track) {
  constexpr double kWalk = 1.5, kFacing = 0.7;  // [m] more than its place errs; cosine (assumed)
  const ClassFilter* walker = track.body_heading ? walkerOf(model, track) : nullptr;
  if (walker == nullptr || isOfImagesAlone(track)) return;
  const Vector2 place = walker->x.head<2>();
  const Vector2 way = place - track.walked_from.value_or(place);
  if (track.walked_from && way.norm() < kWalk) return;
  track.walked_from = place;
  const double yaw = track.body_heading->mean;
  const double along = way.dot(Vector2(std::cos(yaw), std::sin(yaw)));
  if (std::abs(along) <= kFacing * way.norm()) return;
  seeWalk(along, kPlaceVariance, track.body_heading_bit);
  reverseBodyIfAsked(model.params.heading, track);
}

}  // namespace perception
