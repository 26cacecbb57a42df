#include "libperception/detectors/Suppression.h"

#include <algorithm>

namespace perception {

using Box = ObjectDetection::ImageBox;

double areaOf(const Box& b) { return std::max(0.0, b.x2 - b.x1) * std::max(0.0, b.y2 - b.y1); }

double sharedArea(const Box& a, const Box& b) {
  return std::max(0.0, std::min(a.x2, b.x2) - std::max(a.x1, b.x1)) *
         std::max(0.0, std::min(a.y2, b.y2) - std::max(a.y1, b.y1));
}

double overlapOf(const Box& a, const Box& b) {
  const double shared = sharedArea(a, b), both = areaOf(a) + areaOf(b) - shared;
  return both > 0 ? shared / both : 0;
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
