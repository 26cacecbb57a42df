#include "libperception/lidar/outline/BoxFit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "libperception/lidar/outline/PointFours.h"
#include "libperception/simd/Dispatch.h"
#include "libperception/simd/Vector8.h"

namespace perception {

namespace {

/// Points of a cluster relative to the first of them [m].
struct FittedPoints {
  explicit FittedPoints(const std::vector<Vector2>& places)
      : points(places.size(), [&](std::size_t i) {
          const Vector2 d = places[i] - places.front();
          return std::make_pair(static_cast<float>(d.x()), static_cast<float>(d.y()));
        }) {
    Vector2 sum = Vector2::Zero();
    for (const Vector2& place : places) sum += place - places.front();
    const auto count = static_cast<double>(places.size());
    mean_x = static_cast<float>(sum.x() / count), mean_y = static_cast<float>(sum.y() / count);
  }
  PointFours points;
  float mean_x, mean_y;
};

/// That of two bounds which points are nearer to by the sum of squares. That is the one on the side
/// of their `mean`, but where rounding may decide.
template <class Float>
PERCEPTION_LANES Float nearerBound(const PointFours& points, const Float* values, const Float& mean,
                                   const Float& low, const Float& high) {
  using Directions = LaneDirections<Float>;
  constexpr float kShare = 1e-3f, kLeast = 1e-4f;  // [-], [m] far more than rounding
  const Float aside = mean - (low + high) * 0.5f;
  const IntsOf<Float> unsure = magnitude(aside) <= (high - low) * kShare + kLeast;
  bool sure = true;
  for (std::size_t k = 0; k < Directions::kCount; ++k) sure = sure && unsure[4 * k] == 0;
  if (sure) return aside < 0 ? low : high;
  Float to_low{}, to_high{};
  for (std::size_t i = 0; i < points.groups; ++i) {
    const Float w = Directions::same(points.weight[i]);
    const Float v0 = values[i] - low, v1 = high - values[i];
    to_low += w * v0 * v0, to_high += w * v1 * v1;
  }
  const auto sum = [](const Float4& v) { return sumOf(v); };
  return Directions::reduced(to_low, sum) < Directions::reduced(to_high, sum) ? low : high;
}

/// Of each direction the sum over the points of 1 / distance to the nearer of the two rectangle
/// sides that the points lie along; at least `min_distance` [m].
template <class Float>
PERCEPTION_LANES void findCloseness(const FittedPoints& fitted, const float* cosines,
                                    const float* sines, float min_distance, float* closeness) {
  using Directions = LaneDirections<Float>;
  const PointFours& points = fitted.points;
  const TurnedPoints<Float> turned(points, cosines, sines);
  const Float c = Directions::of(cosines), s = Directions::of(sines);
  const Float mean_a = c * fitted.mean_x + s * fitted.mean_y,
              mean_b = c * fitted.mean_y - s * fitted.mean_x;
  const Float edge_a = nearerBound(points, turned.a, mean_a, turned.low_a, turned.high_a);
  const Float edge_b = nearerBound(points, turned.b, mean_b, turned.low_b, turned.high_b);
  const Float floor = all<Float>(min_distance);
  Float sums{};
  for (std::size_t i = 0; i < points.groups; ++i) {
    const Float off_a = larger<Float>(turned.a[i] - edge_a, edge_a - turned.a[i]);
    const Float off_b = larger<Float>(turned.b[i] - edge_b, edge_b - turned.b[i]);
    sums += Directions::same(points.weight[i]) / larger<Float>(smaller(off_a, off_b), floor);
  }
  for (std::size_t k = 0; k < Directions::kCount; ++k)
    closeness[k] = sumOf(Directions::lanesOf(sums, k));
}

// Like PERCEPTION_WIDER, with vectors of the width of each target.
PERCEPTION_TARGET("default")
void findTwo(const FittedPoints& points, const float* cosines, const float* sines,
             float min_distance, float* closeness) {
  for (std::size_t k = 0; k < 2; ++k)
    findCloseness<Float4>(points, cosines + k, sines + k, min_distance, closeness + k);
}
#if PERCEPTION_HAS_WIDER
PERCEPTION_TARGET("avx2")
void findTwo(const FittedPoints& points, const float* cosines, const float* sines,
             float min_distance, float* closeness) {
  findCloseness<Float8>(points, cosines, sines, min_distance, closeness);
}
#endif

/// Directions k * step [rad], k up to and with `steps`, by their cosines and sines.
struct Turns {
  explicit Turns(std::size_t steps = 0, double step = 0) : cosine(steps + 1), sine(steps + 1) {
    for (std::size_t k = 0; k <= steps; ++k) set(k, static_cast<double>(k) * step);
  }
  void set(std::size_t k, double yaw) {
    cosine[k] = static_cast<float>(std::cos(yaw)), sine[k] = static_cast<float>(std::sin(yaw));
  }
  std::vector<float> cosine, sine;
};

/// Of two directions, from one on.
std::array<double, 2> closenessOf(const FittedPoints& points, const Turns& turns, std::size_t first,
                                  const BoxParams& params) {
  std::array<float, 2> closeness;
  findTwo(points, &turns.cosine[first], &turns.sine[first], static_cast<float>(params.min_distance),
          closeness.data());
  return {static_cast<double>(closeness[0]), static_cast<double>(closeness[1])};
}

struct Direction {
  double yaw = 0;       ///< [rad] in [0, pi/2)
  double contrast = 0;  ///< [0, 1] gain over the mean of all directions; 0 for a round cluster
};

Direction bestDirection(const std::vector<Vector2>& places, const BoxParams& params) {
  const FittedPoints points(places);
  const int steps = std::max(2, static_cast<int>(std::lround(kPi / 2 / params.step)));
  const double step = kPi / 2 / steps;
  std::vector<double> score(static_cast<std::size_t>(steps) + 1);  // they come by two
  thread_local Turns quarter, finer_ones(1);  // the first the same for all clusters
  if (quarter.cosine.size() != score.size()) quarter = Turns(score.size() - 1, step);
  for (std::size_t k = 0; k < static_cast<std::size_t>(steps); k += 2) {
    const auto two = closenessOf(points, quarter, k, params);
    score[k] = two[0], score[k + 1] = two[1];
  }
  score.resize(static_cast<std::size_t>(steps));
  double mean = 0;
  std::size_t best = 0;
  for (std::size_t k = 0; k < score.size(); ++k) {
    mean += score[k] / steps;
    if (score[k] > score[best]) best = k;
  }
  double yaw = static_cast<double>(best) * step, high = score[best];
  for (const double finer : {step / 2, step / 4, step / 8}) {
    finer_ones.set(0, yaw + finer), finer_ones.set(1, yaw - finer);
    const auto [left, right] = closenessOf(points, finer_ones, 0, params);
    if (left > high && left >= right) {
      yaw += finer, high = left;
    } else if (right > high) {
      yaw -= finer, high = right;
    }
  }
  return {yaw, high > 0 ? 1 - mean / high : 0};
}

/// At most `limit` points, evenly subsampled.
std::vector<Vector2> evenly(const std::vector<Vector2>& points, int limit) {
  std::vector<Vector2> used;
  constexpr int kMost = static_cast<int>(4 * TurnedPoints<Float8>::kMost);
  const std::size_t stride =
      1 + (points.size() - 1) / static_cast<std::size_t>(std::min(limit, kMost));
  used.reserve((points.size() - 1) / stride + 1);
  for (std::size_t i = 0; i < points.size(); i += stride) used.push_back(points[i]);
  return used;
}

/// Removes the few points that a gap separates from the others along or across yaw: a bollard
/// beside a car, a wing mirror.
std::vector<Vector2> withoutOutliers(const std::vector<Vector2>& points, double yaw,
                                     const BoxParams& params) {
  const double c = std::cos(yaw), s = std::sin(yaw);
  std::vector<double> along, across;
  along.reserve(points.size()), across.reserve(points.size());
  for (const Vector2& p : points)
    along.push_back(c * p.x() + s * p.y()), across.push_back(c * p.y() - s * p.x());
  // Bounds without the few lowest and highest values that a gap separates from the rest.
  const auto bounds = [&params](std::vector<double> values) {
    const auto few =
        static_cast<std::size_t>(params.outlier_share * static_cast<double>(values.size()));
    const std::size_t last = values.size() - 1;
    const auto tail = static_cast<std::ptrdiff_t>(std::min(few + 1, values.size()));
    // Only the ends need sorting.
    std::nth_element(values.begin(), values.begin() + tail - 1, values.end());
    std::sort(values.begin(), values.begin() + tail);
    std::nth_element(values.begin() + tail, values.end() - tail, values.end());
    std::sort(values.end() - tail, values.end());
    double low = values.front(), high = values.back();
    for (std::size_t i = 0; i < few; ++i) {
      if (values[i + 1] - values[i] > params.outlier_gap) low = values[i + 1];
      if (values[last - i] - values[last - i - 1] > params.outlier_gap) high = values[last - i - 1];
    }
    return std::make_pair(low, high);
  };
  const auto [a0, a1] = bounds(along);
  const auto [b0, b1] = bounds(across);
  std::vector<Vector2> kept;
  kept.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    if (along[i] >= a0 && along[i] <= a1 && across[i] >= b0 && across[i] <= b1)
      kept.push_back(points[i]);
  return kept;
}

/// Whether both ends of the rectangle's side along a (its face towards the sensor) were seen.
bool sideComplete(const Rectangle& r, double sensor_a, double sensor_b, bool low_open,
                  bool high_open, double grazing) {
  const double off = sensor_b < r.b0 ? r.b0 - sensor_b : sensor_b > r.b1 ? sensor_b - r.b1 : 0;
  if (off <= 0)
    return false;  // the sensor lies in the extension of the side, which is seen from its end only
  const double farther_end = std::max(std::abs(r.a0 - sensor_a), std::abs(r.a1 - sensor_a));
  if (std::atan2(off, farther_end) < grazing) return false;
  // An end is the outline's edge, unless the adjacent side is also well visible: then it is the
  // corner between them.
  const double depth = off + (r.b1 - r.b0), clear = depth * std::tan(grazing);
  const bool low_is_edge = sensor_a >= r.a0 - clear, high_is_edge = sensor_a <= r.a1 + clear;
  return (low_open || !low_is_edge) && (high_open || !high_is_edge);
}

}  // namespace

std::optional<PartialBox> fitBox(const std::vector<Vector2>& points, const Vector2& sensor,
                                 bool left_open, bool right_open, const BoxParams& params) {
  if (points.size() < 2) return std::nullopt;
  Direction direction = bestDirection(evenly(points, params.max_points), params);
  const std::vector<Vector2> kept = withoutOutliers(points, direction.yaw, params);
  if (kept.size() < points.size())
    direction = bestDirection(evenly(kept, params.max_points), params);
  Rectangle r = rectangleAlong(kept, direction.yaw);
  if (r.a1 - r.a0 < r.b1 - r.b0) r = rectangleAlong(kept, direction.yaw + kPi / 2);
  const double a = r.a1 - r.a0, b = r.b1 - r.b0;
  if (a <= 0) return std::nullopt;

  PartialBox sides;
  sides.yaw = wrapAxis(r.yaw);
  sides.length = a, sides.width = b;
  const double c = std::cos(r.yaw), s = std::sin(r.yaw);
  const double center_a = (r.a0 + r.a1) / 2, center_b = (r.b0 + r.b1) / 2;
  sides.center = {c * center_a - s * center_b, s * center_a + c * center_b};

  // Deviation of yaw: error of an end over half the length; uniform in 90 degrees for a round
  // cluster (method.md 8.6).
  constexpr double kUniformSigma =
      kPi / 2 / 3.4641016151377544;  // [rad] sigma of a uniform quarter turn
  const double from_length = std::atan2(2 * params.corner_sigma, a);
  const double clarity = std::clamp(direction.contrast / 0.25, 0.0, 1.0);
  const double sigma = std::hypot(params.yaw_sigma_min, from_length) / std::max(clarity, 0.01);
  sides.yaw_sigma = std::min(sigma, kUniformSigma);

  // Which end is the left edge: seen from the sensor, left is counter-clockwise.
  const double sensor_a = c * sensor.x() + s * sensor.y(),
               sensor_b = c * sensor.y() - s * sensor.x();
  const bool below = sensor_b < center_b;  // looking towards +b, left is -a
  sides.length_complete = sideComplete(r, sensor_a, sensor_b, below ? left_open : right_open,
                                       below ? right_open : left_open, params.grazing);
  const bool behind = sensor_a < center_a;  // looking towards +a, left is +b
  // A rear whose direction errs by its deviation seems to show a short side beside it.
  const Rectangle across{r.yaw, r.b0, r.b1, r.a0, r.a1};
  sides.width_complete =
      sideComplete(across, sensor_b, sensor_a, behind ? right_open : left_open,
                   behind ? left_open : right_open, params.grazing + sides.yaw_sigma);
  return sides;
}

}  // namespace perception
