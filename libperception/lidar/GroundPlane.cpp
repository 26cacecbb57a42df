#include "libperception/lidar/GroundPlane.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "libperception/core/Random.h"

namespace perception {

void GroundParams::visit(ParamVisitor& v) {
  v.integer("sectors", sectors, {4, 720}, "polar cells around the vehicle");
  v.real("ring", ring, {0.2, 20}, "m", "depth of a polar cell");
  v.real("range_min", range_min, {0, 20}, "m", "nearest ground used");
  v.real("range_max", range_max, {5, 200}, "m", "farthest ground used");
  v.real("quantile", quantile, {0, 0.5}, "", "height of a cell's candidate among its returns");
  v.integer("cell_points", cell_points, {1, 1000}, "returns that a cell needs");
  v.real("tolerance", tolerance, {0.01, 0.5}, "m", "of a RANSAC inlier");
  v.integer("iterations", iterations, {1, 10000}, "of RANSAC");
  v.angle("max_tilt_deg", max_tilt, {0.1, 30}, "largest tilt against the vehicle");
  v.real("max_offset", max_offset, {0.01, 3}, "m", "largest height at the ego origin");
  v.real("min_inliers", min_inliers, {0.01, 1}, "", "share of the candidates that a plane needs");
  v.real("alpha", alpha, {0.001, 1}, "", "weight of a new plane against the last");
  v.real("wet_depth", wet_depth, {0.05, 2}, "m", "returns that far below the plane are mirrored");
  v.real("wet_share", wet_share, {0.001, 1}, "",
         "share of mirrored returns that freezes the plane");
  v.real("wet_range", wet_range, {5, 100}, "m", "range within which that share is taken");
  v.real("freeze", freeze, {0, 60}, "s", "for which a wet road holds the plane");
  v.require(range_min < range_max, "range_min must be below range_max");
}

namespace {

constexpr std::uint32_t kRansacPurpose = 0x67726f75;  // "grou": this user's own random streams

/// The plane through three points as (a, b, c); empty when they lie on a line seen from above.
std::optional<Vector3> planeThrough(const Eigen::Vector3f& p, const Eigen::Vector3f& q,
                                    const Eigen::Vector3f& r) {
  const Vector3 u = (q - p).cast<double>(), v = (r - p).cast<double>();
  const double area = u.x() * v.y() - u.y() * v.x();
  if (std::abs(area) < 1) return std::nullopt;  // [m^2] too thin to tell a slope
  const double a = (u.z() * v.y() - v.z() * u.y()) / area,
               b = (u.x() * v.z() - v.x() * u.z()) / area;
  return Vector3(
      a, b,
      static_cast<double>(p.z()) - a * static_cast<double>(p.x()) - b * static_cast<double>(p.y()));
}

double residual(const Vector3& plane, const Eigen::Vector3f& p) {
  return static_cast<double>(p.z()) - plane[0] * static_cast<double>(p.x()) -
         plane[1] * static_cast<double>(p.y()) - plane[2];
}

}  // namespace

std::vector<Eigen::Vector3f> GroundEstimator::candidates(const EgoPoints& points) const {
  const int rings = static_cast<int>(std::ceil(params_.range_max / params_.ring));
  const auto cells = static_cast<std::size_t>(rings * params_.sectors);
  const auto inverse_ring = static_cast<float>(1 / params_.ring);
  const auto inverse_sector = static_cast<float>(params_.sectors / kTwoPi);
  const auto near = static_cast<float>(params_.range_min),
             far = static_cast<float>(params_.range_max);
  const float depth = plane_.measured ? static_cast<float>(params_.wet_depth) : 1e9f;
  const auto a = static_cast<float>(plane_.a), b = static_cast<float>(plane_.b),
             c = static_cast<float>(plane_.c);

  std::vector<std::uint32_t> cell_of(points.size(), ~0u), start(cells + 1, 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float x = points.x[i], y = points.y[i], range = std::sqrt(x * x + y * y);
    if (range < near || range >= far || points.z[i] < a * x + b * y + c - depth) continue;
    const int sector =
        static_cast<int>((roughBearing(x, y) + 3.14159265f) * inverse_sector) % params_.sectors;
    const int cell = sector * rings + std::min(static_cast<int>(range * inverse_ring), rings - 1);
    cell_of[i] = static_cast<std::uint32_t>(cell);
    ++start[static_cast<std::size_t>(cell) + 1];
  }
  for (std::size_t k = 1; k <= cells; ++k) start[k] += start[k - 1];
  std::vector<std::uint32_t> order(start.back()), next(start.begin(), start.end() - 1);
  for (std::size_t i = 0; i < points.size(); ++i)
    if (cell_of[i] != ~0u) order[next[cell_of[i]]++] = static_cast<std::uint32_t>(i);

  std::vector<Eigen::Vector3f> result;
  for (std::size_t k = 0; k < cells; ++k) {
    const std::size_t count = start[k + 1] - start[k];
    if (count < static_cast<std::size_t>(params_.cell_points)) continue;
    const auto first = order.begin() + start[k], last = order.begin() + start[k + 1];
    const auto nth =
        first + static_cast<std::ptrdiff_t>(params_.quantile * static_cast<double>(count));
    std::nth_element(first, nth, last, [&](std::uint32_t i, std::uint32_t j) {
      return points.z[i] < points.z[j] || (points.z[i] == points.z[j] && i < j);
    });
    result.emplace_back(points.x[*nth], points.y[*nth], points.z[*nth]);
  }
  return result;
}

double GroundEstimator::mirroredShareOf(const EgoPoints& points) const {
  const auto a = static_cast<float>(plane_.a), b = static_cast<float>(plane_.b),
             c = static_cast<float>(plane_.c);
  const auto depth = static_cast<float>(params_.wet_depth);
  const auto range2 = static_cast<float>(params_.wet_range * params_.wet_range);
  std::size_t near = 0, below = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float x = points.x[i], y = points.y[i];
    const bool counts = x * x + y * y < range2;
    near += counts;
    below += counts && points.z[i] < a * x + b * y + c - depth;
  }
  return near == 0 ? 0 : static_cast<double>(below) / static_cast<double>(near);
}

std::optional<GroundPlane> GroundEstimator::fit(const std::vector<Eigen::Vector3f>& candidates,
                                                const Stamp& stamp) const {
  const auto count = static_cast<std::uint32_t>(candidates.size());
  if (count < 6) return std::nullopt;
  Rng rng(RngKey{seed_, static_cast<std::uint64_t>(stamp.ns), 0, kRansacPurpose});
  const double max_slope = std::tan(params_.max_tilt);

  Vector3 best = Vector3::Zero();
  int best_inliers = 0;
  for (int i = 0; i < params_.iterations; ++i) {
    const std::uint32_t p = rng.below(count), q = rng.below(count), r = rng.below(count);
    const auto plane = planeThrough(candidates[p], candidates[q], candidates[r]);
    if (!plane || std::hypot((*plane)[0], (*plane)[1]) > max_slope ||
        std::abs((*plane)[2]) > params_.max_offset)
      continue;
    int inliers = 0;
    for (const auto& candidate : candidates)
      inliers += std::abs(residual(*plane, candidate)) < params_.tolerance;
    if (inliers > best_inliers) best = *plane, best_inliers = inliers;
  }
  if (best_inliers < std::max(6.0, params_.min_inliers * count)) return std::nullopt;

  double sigma = params_.tolerance / 3;
  for (int pass = 0; pass < 3; ++pass) {
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    Vector3 rhs = Vector3::Zero();
    double squares = 0;
    int used = 0;
    for (const auto& candidate : candidates) {
      const double r = residual(best, candidate);
      if (std::abs(r) > 3 * sigma) continue;
      const Vector3 row(static_cast<double>(candidate.x()), static_cast<double>(candidate.y()), 1);
      A += row * row.transpose(), rhs += row * r, squares += r * r, ++used;
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
  const EgoPoints points = usablePoints(frame, all);
  mirrored_share_ = mirroredShareOf(points);
  wet_ = plane_.measured && frame.stamp < frozen_until_;
  if (wet_) return plane_;

  // After a freeze one plane is measured whatever the returns say: else a lasting change of pitch
  // would freeze for good.
  if (plane_.measured && !froze_ && mirrored_share_ > params_.wet_share) {
    frozen_until_ = frame.stamp + params_.freeze;
    wet_ = froze_ = true;
    return plane_;
  }
  const auto measured = fit(candidates(points), frame.stamp);
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
