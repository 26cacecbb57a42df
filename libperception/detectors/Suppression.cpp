#include "libperception/detectors/Suppression.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "libperception/core/Angle.h"

namespace perception {
namespace {

using Box = ObjectDetection::ImageBox;

constexpr double kSameView = 0.6;  // least overlap of boxes of two components for one object

/// Mean of the headings of the kept component and its neighbors, weighted by e^{2 score} of their
/// best score near the box (method.md 8.8).
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

double areaOf(const Box& b) { return std::max(0.0, b.x2 - b.x1) * std::max(0.0, b.y2 - b.y1); }

double sharedArea(const Box& a, const Box& b) {
  return std::max(0.0, std::min(a.x2, b.x2) - std::max(a.x1, b.x1)) *
         std::max(0.0, std::min(a.y2, b.y2) - std::max(a.y1, b.y1));
}

double overlapOf(const Box& a, const Box& b) {
  const double shared = sharedArea(a, b), both = areaOf(a) + areaOf(b) - shared;
  return both > 0 ? shared / both : 0;
}

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

std::vector<ObjectDetection> suppressed(std::vector<ObjectDetection> objects, double overlap) {
  std::stable_sort(objects.begin(), objects.end(),
                   [](const auto& a, const auto& b) { return a.score > b.score; });
  std::vector<ObjectDetection> kept;
  for (ObjectDetection& d : objects) {
    const bool same = std::any_of(kept.begin(), kept.end(), [&](const ObjectDetection& k) {
      return k.label == d.label && k.image_box && d.image_box &&
             overlapOf(*k.image_box, *d.image_box) > overlap;
    });
    if (!same) kept.push_back(std::move(d));
  }
  return kept;
}

}  // namespace perception
