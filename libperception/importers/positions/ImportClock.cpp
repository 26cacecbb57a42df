#include "libperception/importers/positions/ImportClock.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "libperception/core/PoseSteps.h"
#include "libperception/core/math/Median.h"

namespace perception {
namespace {

/// [periods] A longer step of the stamps is a clock step or a lost fix.
constexpr double kStep = 3;
/// [s] A clock that has run for this long since a backward step was reset.
constexpr double kSetAnew = 2;
/// [m] Cell size for the comparison of scans, about the depth of walls and hedges.
constexpr double kCell = 0.2;
/// [m] Band above the road: excludes the road, which looks the same everywhere, and trees.
constexpr double kLowest = 0.8, kHighest = 3;
/// [m] Range limits: nearer returns are of the vehicle itself, farther ones too sparse.
constexpr double kNearest = 3, kFarthest = 25;
constexpr double kCoarse = 0.1, kFine = 0.02;  ///< [s] steps of the search
constexpr std::size_t kFewestReturns = 1000;   ///< fewest returns

double medianPeriod(const std::vector<GpsFix>& fixes) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < fixes.size(); ++i) {
    const double step = fixes[i].stamp - fixes[i - 1].stamp;
    if (step > 0) steps.push_back(step);
  }
  return steps.empty() ? 0 : medianOf(std::move(steps));
}

/// Cells of the ground plane that hold a return, all scans placed by the poses moved by `shift`.
std::size_t coveredCells(const std::vector<StampedPose>& poses,
                         const std::vector<StampedScan>& scans, double shift) {
  std::vector<std::int64_t> cells;
  for (const auto& [stamp, points] : scans) {
    const auto pose = poseBetween(poses, stamp + -shift);
    if (!pose) continue;
    for (const Vector3& p : points) {
      const Vector3 w = *pose * p;
      const auto column = static_cast<std::int64_t>(std::floor(w.x() / kCell));
      const auto row = static_cast<std::int64_t>(std::floor(w.y() / kCell));
      cells.push_back(column * (std::int64_t{1} << 32) + row);
    }
  }
  std::sort(cells.begin(), cells.end());
  return static_cast<std::size_t>(std::unique(cells.begin(), cells.end()) - cells.begin());
}

std::vector<StampedScan> usefulParts(const std::vector<StampedScan>& scans) {
  std::vector<StampedScan> out;
  for (const auto& [stamp, points] : scans) {
    StampedScan& part = out.emplace_back(stamp, std::vector<Vector3>());
    for (const Vector3& p : points) {
      const double range = p.head<2>().norm();
      if (p.z() > kLowest && p.z() < kHighest && range > kNearest && range < kFarthest)
        part.second.push_back(p);
    }
  }
  return out;
}

}  // namespace

std::vector<GpsFix> steadyFixes(const std::vector<GpsFix>& fixes, std::size_t& dropped) {
  const double period = medianPeriod(fixes);
  std::vector<GpsFix> out;
  bool behind = false;  // the clock stepped back and has not come forward again
  for (std::size_t i = 0; i < fixes.size(); ++i) {
    const GpsFix& fix = fixes[i];
    if (!out.empty()) {
      if (fix.stamp == fixes[i - 1].stamp) continue;  // duplicate
      const double step = fix.stamp - fixes[i - 1].stamp;
      if (step < 0) behind = true;
      if (step > kStep * period || fix.stamp - out.back().stamp > kSetAnew) behind = false;
      if (behind || fix.stamp <= out.back().stamp) {
        ++dropped;
        continue;
      }
    }
    out.push_back(fix);
  }
  return out;
}

std::optional<Pose3> poseBetween(const std::vector<StampedPose>& poses, Stamp stamp) {
  const auto after = std::lower_bound(poses.begin(), poses.end(), stamp,
                                      [](const StampedPose& p, Stamp t) { return p.stamp < t; });
  if (after == poses.end()) return {};
  if (after->stamp == stamp) return after->pose;
  if (after == poses.begin()) return {};
  const StampedPose& before = *std::prev(after);
  return interpolate(before.pose, after->pose,
                     (stamp - before.stamp) / (after->stamp - before.stamp));
}

std::optional<double> clockShift(const std::vector<StampedPose>& poses,
                                 const std::vector<StampedScan>& scans, double start,
                                 double reach) {
  const std::vector<StampedScan> parts = usefulParts(scans);
  std::size_t returns = 0;
  for (const auto& part : parts) returns += part.second.size();
  if (poses.size() < 2 || parts.size() < 2 || returns < kFewestReturns) return {};
  const double least = std::max(start - reach, parts.back().first - poses.back().stamp);
  const double most = std::min(start + reach, parts.front().first - poses.front().stamp);
  const auto bestOf = [&](double from, double to, double step) {
    double best = from;
    std::size_t fewest = SIZE_MAX;
    for (int k = 0; from + k * step <= to; ++k) {
      const std::size_t cells = coveredCells(poses, parts, from + k * step);
      if (cells >= fewest) continue;
      fewest = cells;
      best = from + k * step;
    }
    return best;
  };
  if (most - least < 4 * kCoarse) return {};
  const double coarse = bestOf(least, most, kCoarse);
  if (coarse - least < kCoarse || most - coarse < 1.5 * kCoarse) return {};
  return bestOf(coarse - kCoarse, coarse + kCoarse, kFine);
}

}  // namespace perception
