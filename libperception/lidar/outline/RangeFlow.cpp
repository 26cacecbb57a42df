#include "libperception/lidar/outline/RangeFlow.h"

#include <algorithm>
#include <cmath>

namespace perception {
namespace {

// All values are assumed, but kLeastVotes and kClearly, which were chosen on recorded snow.
constexpr double kWayStep = 0.1;      // [m] step of the histogram of ways
constexpr double kSlowest = 3;        // [m/s] below which nothing is said
constexpr double kLeastVotes = 10;    // cells that have to agree
constexpr double kLeastShare = 0.15;  // share of the cells that has to agree
constexpr double kClearly = 2;        // least ratio of the votes to those of any other way
constexpr int kOwnSteps = 4;          // steps to each side that belong to the best way
constexpr double kAgrees = 0.15;      // [m] by which a range may miss the way

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

std::optional<double> RangeFlow::way(double dt) const {
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
  if (votes < kLeastVotes || votes < kLeastShare * cells || votes < kClearly * other)
    return std::nullopt;
  double sum = 0, weight = 0;
  for (int s = best - 2; s <= best + 2; ++s)
    sum += ways.at(s) * ways.wayOf(s), weight += ways.at(s);
  return sum / weight;
}

bool RangeFlow::agrees(std::size_t cell, float range, double way) const {
  const Ranges& before = before_[cell];
  return std::any_of(
      before.range.begin(), before.range.begin() + static_cast<std::ptrdiff_t>(before.n),
      [&](float r) { return std::abs(static_cast<double>(range - r) - way) < kAgrees; });
}

}  // namespace perception
