#include "libperception/detectors/dpm/DpmSuppression.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "libperception/core/math/Angle.h"
#include "libperception/detectors/Suppression.h"

namespace perception {
namespace {

constexpr double kSameView = 0.6;  // overlap of two components' boxes around one object

/// The kept component's heading and those of its neighbors, each with its best score near the box,
/// weighted by e^{2 score}.
double refinedHeading(const DpmDetection& kept, const std::vector<const DpmDetection*>& around) {
  std::map<int, const DpmDetection*> best;
  for (const DpmDetection* d : around) {
    if (!d->heading || std::abs(wrapAngle(*d->heading - *kept.heading)) > radians(50)) continue;
    const DpmDetection*& b = best[d->component];
    if (b == nullptr || d->score > b->score) b = d;
  }
  double sum = 0, weights = 0;
  for (const auto& [component, d] : best) {
    const double weight = std::exp(2 * (d->score - kept.score));
    sum += weight * wrapAngle(*d->heading - *kept.heading);
    weights += weight;
  }
  return weights > 0 ? wrapAngle(*kept.heading + sum / weights) : *kept.heading;
}

}  // namespace

std::vector<DpmDetection> suppressed(std::vector<DpmDetection> places, double overlap) {
  std::stable_sort(places.begin(), places.end(),
                   [](const auto& a, const auto& b) { return a.score > b.score; });
  std::vector<DpmDetection> kept;
  std::vector<std::vector<const DpmDetection*>> around;
  for (const DpmDetection& d : places) {
    bool free = true;
    for (std::size_t i = 0; i < kept.size(); ++i) {
      if (kept[i].target != d.target) continue;
      const double shared = sharedArea(kept[i].box, d.box);
      if (shared <= 0) continue;
      if (shared > overlap * areaOf(d.box)) free = false;
      if (overlapOf(kept[i].box, d.box) >= kSameView) around[i].push_back(&d);
    }
    if (!free) continue;
    kept.push_back(d);
    around.push_back({&d});
  }
  std::vector<DpmDetection> out = kept;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (kept[i].heading) out[i].heading = refinedHeading(kept[i], around[i]);
  }
  return out;
}

}  // namespace perception
