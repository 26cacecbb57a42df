#include "libperception/lidar/ground/GroundPlane.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "libperception/core/math/Random.h"
#include "libperception/simd/Dispatch.h"

namespace perception {

void GroundParams::visit(ParamVisitor& v) {
  v.expert();
  v.real("max_offset", max_offset, {0.01, 3}, "m",
         "largest height of the ground at the ego origin");
}

namespace {

constexpr double kMissed = 1e-5;                      // probability of a miss at which RANSAC stops
constexpr std::uint32_t kRansacPurpose = 0x67726f75;  // "grou": separate random streams

/// The plane through three points as (a, b, c); empty when they are collinear in the horizontal
/// plane.
std::optional<Vector3> planeThrough(const Vector3& p, const Vector3& q, const Vector3& r) {
  const Vector3 u = q - p, v = r - p;
  const double area = u.x() * v.y() - u.y() * v.x();
  if (std::abs(area) < 1) return std::nullopt;  // [m^2] a slope would be too uncertain
  const double a = (u.z() * v.y() - v.z() * u.y()) / area,
               b = (u.x() * v.z() - v.x() * u.z()) / area;
  return Vector3(a, b, p.z() - a * p.x() - b * p.y());
}

/// Range and depth below the plane of mirrored returns.
struct MirrorRules {
  float a, b, c, depth;  ///< the plane; [m] below it
  float far;             ///< [m]
};

/// Numbers of points within `far` and of those more than `depth` below the plane.
struct NearCounts {
  std::int32_t near, below;
};
PERCEPTION_WIDEST NearCounts countNear(const float* __restrict x, const float* __restrict y,
                                       const float* __restrict z, std::size_t count,
                                       const MirrorRules k) {
  const float far2 = k.far * k.far;
  NearCounts counts{0, 0};
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t near = x[i] * x[i] + y[i] * y[i] < far2;
    counts.near += near;
    counts.below += near & (z[i] < k.a * x[i] + k.b * y[i] + k.c - k.depth);
  }
  return counts;
}

}  // namespace

double GroundEstimator::mirroredShareOf(const EgoPoints& points) const {
  const MirrorRules within{static_cast<float>(plane_.a), static_cast<float>(plane_.b),
                           static_cast<float>(plane_.c), static_cast<float>(params_.wet_depth),
                           static_cast<float>(params_.wet_range)};
  const NearCounts counts =
      countNear(points.x.data(), points.y.data(), points.z.data(), points.size(), within);
  return counts.near == 0 ? 0 : static_cast<double>(counts.below) / counts.near;
}

std::optional<GroundPlane> GroundEstimator::fit(const GroundCandidates& candidates,
                                                const Stamp& stamp) const {
  const auto count = static_cast<std::uint32_t>(candidates.size());
  if (count < 6) return std::nullopt;
  Rng rng(RngKey{seed_, static_cast<std::uint64_t>(stamp.ns), 0, kRansacPurpose});
  const double max_slope = std::tan(params_.max_tilt);
  const auto place = [&candidates](std::uint32_t i) {
    return Vector3(static_cast<double>(candidates.x[i]), static_cast<double>(candidates.y[i]),
                   static_cast<double>(candidates.z[i]));
  };

  Vector3 best = Vector3::Zero();
  int best_inliers = 0;
  const auto tolerance = static_cast<float>(params_.tolerance);
  double missed = 1;  // probability that no draw so far was of three inliers of the best plane
  for (int i = 0; i < params_.iterations && missed > kMissed; ++i) {
    const std::uint32_t p = rng.below(count), q = rng.below(count), r = rng.below(count);
    const auto plane = planeThrough(place(p), place(q), place(r));
    if (!plane || std::hypot((*plane)[0], (*plane)[1]) > max_slope ||
        std::abs((*plane)[2]) > params_.max_offset)
      continue;
    const Eigen::Vector3f n = plane->cast<float>();
    int inliers = 0;
    for (std::uint32_t k = 0; k < count; ++k) {
      const float off = candidates.z[k] - n.x() * candidates.x[k] - n.y() * candidates.y[k] - n.z();
      inliers += (off < tolerance) & (off > -tolerance);
    }
    if (inliers > best_inliers) best = *plane, best_inliers = inliers;
    const double share = static_cast<double>(best_inliers) / count;
    missed = std::pow(1 - share * share * share, i + 1);
  }
  if (best_inliers < std::max(6.0, params_.min_inliers * count)) return std::nullopt;

  double sigma = params_.tolerance / 3;
  for (int pass = 0; pass < 3; ++pass) {
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    Vector3 rhs = Vector3::Zero();
    double squares = 0;
    int used = 0;
    for (std::uint32_t k = 0; k < count; ++k) {
      const Vector3 at = place(k), row(at.x(), at.y(), 1);
      const double off = at.z() - best.dot(row);
      if (std::abs(off) > 3 * sigma) continue;
      A += row * row.transpose(), rhs += row * off, squares += off * off, ++used;
    }
    if (used < 6) break;
    const Eigen::LDLT<Eigen::Matrix3d> solver(A);
    if (solver.info() != Eigen::Success || solver.rcond() < 1e-9) break;
    best += solver.solve(rhs);
    sigma = std::clamp(std::sqrt(squares / (used - 3)), 0.01, params_.tolerance);
  }
  if (std::hypot(best[0], best[1]) > max_slope || std::abs(best[2]) > params_.max_offset)
    return std::nullopt;
  return GroundPlane{best[0], best[1], best[2], sigma, true};
}

GroundPlane GroundEstimator::update(const SensorFrame& frame) {
  PointParams all;
  all.range_min = params_.range_min,
  all.range_max = params_.range_max + frame.T_ego_sensor.translation().norm();
  all.max_points = params_.max_points;
  const EgoPoints points = usablePoints(frame, all);
  mirrored_share_ = mirroredShareOf(points);
  // Farther off than a freeze lasts: the clock has gone back.
  wet_ = plane_.measured && frame.stamp < frozen_until_ &&
         frozen_until_ - frame.stamp <= params_.freeze;
  if (wet_) return plane_;

  // After a freeze one plane is measured in any case: otherwise a lasting change of pitch would
  // never be followed.
  if (plane_.measured && !froze_ && mirrored_share_ > params_.wet_share) {
    frozen_until_ = frame.stamp + params_.freeze;
    wet_ = froze_ = true;
    return plane_;
  }
  const CandidateRules rules{params_.sectors,
                             params_.ring,
                             params_.range_min,
                             params_.range_max,
                             params_.quantile,
                             params_.cell_points,
                             plane_,
                             plane_.measured ? params_.wet_depth : 1e9};
  const auto measured = fit(groundCandidates(points, rules), frame.stamp);
  if (!measured) return plane_;
  froze_ = false;
  const double alpha = plane_.measured ? params_.alpha : 1;
  plane_ = {plane_.a + alpha * (measured->a - plane_.a),
            plane_.b + alpha * (measured->b - plane_.b),
            plane_.c + alpha * (measured->c - plane_.c),
            plane_.sigma + alpha * (measured->sigma - plane_.sigma), true};
  return plane_;
}

}  // namespace perception
