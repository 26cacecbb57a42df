#include "gui-offscreen/drawing/LabelLayout.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace perception {
namespace {

constexpr double kRing = 10;      // [px] between tried distances
constexpr int kDirections = 16;   // tried around the object
constexpr double kNarrowest = 3;  // [px] between label and object

// The label at `distance` from the object's outline in a direction.
Rect placeAt(const LabelWish& wish, double angle, double distance) {
  const double cx = wish.object.x + wish.object.width / 2;
  const double cy = wish.object.y + wish.object.height / 2;
  const double c = std::cos(angle), s = std::sin(angle);
  const double half_w = (wish.object.width + wish.width) / 2 + distance;
  const double half_h = (wish.object.height + wish.height) / 2 + distance;
  // On the boundary of the rectangle at which the two do not overlap.
  const double stretch =
      std::min(half_w / std::max(1e-9, std::abs(c)), half_h / std::max(1e-9, std::abs(s)));
  return {cx + stretch * c - wish.width / 2, cy + stretch * s - wish.height / 2, wish.width,
          wish.height};
}

bool isFree(const Rect& place, const std::vector<Rect>& taken) {
  return std::none_of(taken.begin(), taken.end(), [&](const Rect& r) { return r.overlaps(place); });
}

std::optional<Rect> findPlace(const LabelWish& wish, const std::vector<Rect>& taken,
                              const Rect& area) {
  for (double distance = kNarrowest; distance <= wish.reach; distance += kRing) {
    for (int i = 0; i < kDirections; ++i) {
      // Above first, then to both sides of it in turn.
      const int turn = (i + 1) / 2 * (i % 2 ? 1 : -1);
      const Rect place = placeAt(wish, -kPi / 2 + turn * kTwoPi / kDirections, distance);
      if (area.contains(place) && isFree(place, taken)) return place;
    }
  }
  return std::nullopt;
}

}  // namespace

std::vector<std::optional<Rect>> placeLabels(const std::vector<LabelWish>& wishes,
                                             const std::vector<Rect>& taken, const Rect& area) {
  std::vector<std::size_t> order(wishes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return wishes[a].rank < wishes[b].rank; });
  std::vector<Rect> labels = taken, labels_and_objects = taken;
  for (const LabelWish& wish : wishes) labels_and_objects.push_back(wish.object);
  std::vector<std::optional<Rect>> places(wishes.size());
  for (const std::size_t i : order) {
    places[i] = findPlace(wishes[i], labels_and_objects, area);
    if (!places[i]) places[i] = findPlace(wishes[i], labels, area);
    if (!places[i]) continue;
    labels.push_back(*places[i]);
    labels_and_objects.push_back(*places[i]);
  }
  return places;
}

}  // namespace perception
