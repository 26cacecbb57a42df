#include "libperception/sensors/ego/PoseMotion.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/core/math/Angle.h"
#include "libperception/core/math/Median.h"

namespace perception {
namespace {

/// [s] Differences are taken over about this time, to suppress the noise of poses at 100 Hz.
constexpr double kDifference = 0.1;
// All assumed:
constexpr double kLongestFit = 1;                                    // [s]
constexpr double kGoodVelocity = 0.1, kGoodYawRate = radians(0.25);  // [m/s], [rad/s]
constexpr std::ptrdiff_t kLeastFit = 4;                              // poses beside the first one
constexpr std::ptrdiff_t kNoiseSamples = 20;                         // poses that tell of the noise

/// One coordinate of the poses: its value after that of the pose nearest to the instant.
class Coordinate {
 public:
  Coordinate(const std::deque<EgoState>& poses, std::ptrdiff_t about, Stamp stamp, int axis)
      : poses_(poses), stamp_(stamp), axis_(axis), about_(about) {}

  double time(std::ptrdiff_t i) const { return at(i).stamp - stamp_; }  ///< [s] after the instant
  double value(std::ptrdiff_t i) const {
    if (axis_ == 2) return wrapAngle(yawOf(at(i).T_world_ego) - yawOf(at(about_).T_world_ego));
    return (at(i).T_world_ego.translation() - at(about_).T_world_ego.translation())[axis_];
  }
  std::ptrdiff_t count() const { return static_cast<std::ptrdiff_t>(poses_.size()); }

  /// Standard deviation of a pose by the poses from `begin` to `end`: by how much each misses the
  /// parabola through the three before it. A vehicle's motion follows it; their median, so that
  /// single leaps do not count. 0: too few poses.
  double noise(std::ptrdiff_t begin, std::ptrdiff_t end) const {
    std::vector<double> misses;
    for (std::ptrdiff_t i = begin + 3; i < end; ++i) {
      double miss = value(i), square = 1;
      for (std::ptrdiff_t a = i - 3; a < i; ++a) {
        double weight = 1;  // of the parabola's value, by Lagrange
        for (std::ptrdiff_t b = i - 3; b < i; ++b)
          if (b != a) weight *= (time(i) - time(b)) / (time(a) - time(b));
        miss -= weight * value(a), square += weight * weight;
      }
      misses.push_back(std::abs(miss) / std::sqrt(square));
    }
    if (misses.size() < 3) return 0;
    constexpr double kMedian = 0.6745;  // of a normal deviate's size
    return medianOf(std::move(misses)) / kMedian;
  }

 private:
  const EgoState& at(std::ptrdiff_t i) const { return poses_[static_cast<std::size_t>(i)]; }

  const std::deque<EgoState>& poses_;
  Stamp stamp_;
  int axis_;
  std::ptrdiff_t about_;
};

/// The parabola through the values of the poses `first` to `last`, both included.
struct Parabola {
  double slope = 0;   ///< [1/s] at the instant
  double spread = 0;  ///< [1/s^2] variance of the slope over that of a value

  Parabola(const Coordinate& of, std::ptrdiff_t first, std::ptrdiff_t last) {
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    Vector3 products = Vector3::Zero();
    for (std::ptrdiff_t i = first; i <= last; ++i) {
      const Vector3 powers = powersOf(of.time(i));
      squares += powers * powers.transpose();
      products += of.value(i) * powers;
    }
    const Eigen::Matrix3d inverse = squares.inverse();
    const Vector3 fit = inverse * products;
    slope = fit[1], spread = inverse(1, 1);
  }

 private:
  static Vector3 powersOf(double t) { return {1, t, t * t}; }
};

/// The slope of a coordinate at the instant, which lies about the poses `first` to `last`, with
/// `noise` of each. `good`: standard deviation of the slope that suffices.
double slopeOf(const Coordinate& of, std::ptrdiff_t first, std::ptrdiff_t last, double noise,
               double good) {
  const double passed = of.time(last) - of.time(first);
  double slope = (of.value(last) - of.value(first)) / passed;
  double deviation = noise * std::sqrt(2) / passed;
  while (deviation > good) {
    if (first > 0)
      --first;
    else if (last + 1 < of.count())
      ++last;
    else
      break;
    if (of.time(last) - of.time(first) > kLongestFit) break;
    if (last - first < kLeastFit) continue;
    const Parabola fit(of, first, last);
    if (noise * std::sqrt(fit.spread) >= deviation) continue;
    slope = fit.slope, deviation = noise * std::sqrt(fit.spread);
  }
  return slope;
}

}  // namespace

PoseMotion motionAt(const std::deque<EgoState>& poses, Stamp stamp) {
  if (poses.size() < 2) return {};
  const auto count = static_cast<std::ptrdiff_t>(poses.size());
  const auto at = [&](std::ptrdiff_t i) { return poses[static_cast<std::size_t>(i)].stamp; };
  // The two poses around the instant, extended on both sides until they are kDifference apart.
  std::ptrdiff_t last =
      std::lower_bound(poses.begin(), poses.end(), stamp,
                       [](const EgoState& pose, Stamp s) { return pose.stamp < s; }) -
      poses.begin();
  last = std::clamp<std::ptrdiff_t>(last, 1, count - 1);
  std::ptrdiff_t first = last - 1;
  const std::ptrdiff_t about = last;
  while (at(last) - at(first) < kDifference && (first > 0 || last + 1 < count)) {
    first = std::max<std::ptrdiff_t>(first - 1, 0);
    last = std::min(last + 1, count - 1);
  }
  const std::ptrdiff_t begin = std::max<std::ptrdiff_t>(last + 1 - kNoiseSamples, 0);
  std::array<double, 3> slopes{}, noise{};
  for (int axis = 0; axis < 3; ++axis)
    noise[static_cast<std::size_t>(axis)] =
        Coordinate(poses, about, stamp, axis).noise(begin, last + 1);
  noise[0] = noise[1] = std::max(noise[0], noise[1]);
  for (int axis = 0; axis < 3; ++axis)
    slopes[static_cast<std::size_t>(axis)] =
        slopeOf(Coordinate(poses, about, stamp, axis), first, last,
                noise[static_cast<std::size_t>(axis)], axis == 2 ? kGoodYawRate : kGoodVelocity);
  return {{slopes[0], slopes[1]}, slopes[2]};
}

}  // namespace perception
