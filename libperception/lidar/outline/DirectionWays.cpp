#include "libperception/lidar/outline/DirectionWays.h"

#include <algorithm>
#include <cmath>

namespace perception {
namespace {

// All assumed.
constexpr double kWayStep = 0.1;      // [m] of the histogram
constexpr double kSlowest = 3;        // [m/s]: the tracks of what is slower start well without
constexpr double kLeastAlike = 10;    // that agree
constexpr double kLeastShare = 0.15;  // of them
constexpr double kClearly = 2;        // times as many as of any other way, or of none
constexpr int kOwnSteps = 4;          // to each side of the best way, that are no other
constexpr double kAgrees = 0.15;      // [m]

/// Votes of the cells for ways, in steps.
class Histogram {
 public:
  explicit Histogram(double farthest)
      : most_(static_cast<int>(std::ceil(farthest / kWayStep))),
        votes_(static_cast<std::size_t>(2 * most_ + 1)) {}

  int last() const { return 2 * most_; }
  /// Below 0 or above last(): too far.
  int stepOf(double way) const { return static_cast<int>(std::lround(way / kWayStep)) + most_; }
  double wayOf(int step) const { return (step - most_) * kWayStep; }
  void add(int step, double votes) { votes_[static_cast<std::size_t>(step)] += votes; }
  double at(int step) const {
    return step < 0 || step > last() ? 0 : votes_[static_cast<std::size_t>(step)];
  }
  double about(int step) const { return at(step - 1) + at(step) + at(step + 1); }
  bool isNone(int step) const { return std::abs(step - most_) <= 1; }

 private:
  int most_;
  std::vector<double> votes_;
};

}  // namespace

std::optional<double> DirectionWays::way(double dt) const {
  Histogram ways(kFastest * dt);
  double cells = 0;
  for (std::size_t c = 0; c < now_.size(); ++c) {
    if (before_[c].n == 0) continue;
    std::array<int, kMostInCell * kMostInCell> steps{};
    std::size_t n = 0;
    for (std::size_t i = 0; i < now_[c].n; ++i) {
      for (std::size_t j = 0; j < before_[c].n; ++j) {
        const int step = ways.stepOf(static_cast<double>(now_[c].range[i] - before_[c].range[j]));
        if (step >= 0 && step <= ways.last()) steps[n++] = step;
      }
    }
    for (std::size_t k = 0; k < n; ++k) ways.add(steps[k], 1 / static_cast<double>(n));
    cells += n > 0;
  }
  int best = 0;
  for (int s = 1; s <= ways.last(); ++s)
    if (ways.about(s) > ways.about(best)) best = s;
  if (std::abs(ways.wayOf(best)) < kSlowest * dt) return std::nullopt;
  double other = 0;
  for (int s = 0; s <= ways.last(); ++s)
    if (std::abs(s - best) > kOwnSteps || ways.isNone(s)) other = std::max(other, ways.about(s));
  const double votes = ways.about(best);
  if (votes < kLeastAlike || votes < kLeastShare * cells || votes < kClearly * other)
    return std::nullopt;
  double sum = 0, weight = 0;
  for (int s = best - 2; s <= best + 2; ++s)
    sum += ways.at(s) * ways.wayOf(s), weight += ways.at(s);
  return sum / weight;
}

bool DirectionWays::agrees(std::size_t cell, float range, double way) const {
  const Ranges& before = before_[cell];
  return std::any_of(
      before.range.begin(), before.range.begin() + static_cast<std::ptrdiff_t>(before.n),
      [&](float r) { return std::abs(static_cast<double>(range - r) - way) < kAgrees; });
}

}  // namespace perception
