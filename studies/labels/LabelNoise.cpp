#include "studies/labels/LabelNoise.h"

#include <algorithm>

namespace perception {
namespace {

// Boxes of one object, highest score first.
using Thing = std::vector<std::size_t>;

std::vector<Thing> thingsOf(const std::vector<ObjectDetection>& boxes,
                            const std::vector<std::string>& labels, double distance) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (boxes[i].space_box && std::count(labels.begin(), labels.end(), boxes[i].label))
      order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return boxes[a].score > boxes[b].score; });
  std::vector<Thing> things;
  for (const std::size_t i : order) {
    const auto joins = [&](const Thing& thing) {
      const Vector3 d =
          boxes[i].space_box->bottom_center - boxes[thing.front()].space_box->bottom_center;
      return d.head<2>().norm() < distance &&
             std::none_of(thing.begin(), thing.end(),
                          [&](std::size_t j) { return boxes[j].label == boxes[i].label; });
    };
    const auto thing = std::find_if(things.begin(), things.end(), joins);
    thing != things.end() ? thing->push_back(i) : things.push_back({i});
  }
  return things;
}

std::string otherLabel(const std::string& label, const std::vector<std::string>& labels, Rng& rng) {
  std::vector<std::string> others;
  for (const auto& l : labels) {
    if (l != label) others.push_back(l);
  }
  return others.empty() ? label : others[rng.below(static_cast<std::uint32_t>(others.size()))];
}

}  // namespace

void corruptLabels(const LabelNoise& damage, const std::vector<std::string>& labels,
                   double group_distance, const RngKey& key, ObjectDetections& detections) {
  if (damage.kind == LabelNoise::kNone) return;
  std::vector<bool> gone(detections.objects.size(), false);
  Rng rng(key);
  for (const Thing& thing : thingsOf(detections.objects, labels, group_distance)) {
    // Drawn for every object, corrupted or not, so that draws are independent of other objects.
    const double u = rng.uniform();
    const std::string& label = detections.objects[thing.front()].label;
    const std::string other = otherLabel(label, labels, rng);
    if (u >= damage.probability) continue;
    for (std::size_t i = 1; i < thing.size(); ++i) gone[thing[i]] = true;
    detections.objects[thing.front()].label =
        damage.kind == LabelNoise::kDropped ? kNoLabel : other;
  }
  std::vector<ObjectDetection> kept;
  for (std::size_t i = 0; i < gone.size(); ++i) {
    if (!gone[i]) kept.push_back(std::move(detections.objects[i]));
  }
  detections.objects = std::move(kept);
}

void keepLabel(const std::string& label, bool without_label, ObjectDetections& detections) {
  auto& boxes = detections.objects;
  boxes.erase(std::remove_if(boxes.begin(), boxes.end(),
                             [&](const ObjectDetection& o) {
                               return o.label != label && !(without_label && o.label == kNoLabel);
                             }),
              boxes.end());
}

}  // namespace perception
