#include "libperception/simulation/weather/sensors/FalseBoxes.h"

#include <algorithm>
#include <variant>

namespace perception {
namespace {

// False boxes for each right one at precision p: (1 - p) / p; in rain less in sun [radecki2016].
constexpr double falsePerRight(double sunny, double rainy) { return 1 / rainy - 1 / sunny; }
constexpr double kCars = falsePerRight(.95, .93), kPeople = falsePerRight(.90, .76);
constexpr double kMirrored = 0.5;                        // share in the road, assumed
constexpr double kLeastScore = 0.3, kMostScore = 0.7;    // as of other false boxes, assumed
constexpr double kLeastHeight = 0.5, kMostHeight = 1.0;  // of the mirrored box, assumed

// The box upside down below its lower edge, or the same box elsewhere at the same height.
ObjectDetection::ImageBox placed(ObjectDetection::ImageBox b, const CameraModel& camera, Rng& rng) {
  if (rng.uniform() < kMirrored) {
    const double height = rng.uniform(kLeastHeight, kMostHeight) * (b.y2 - b.y1);
    b.y1 = b.y2, b.y2 += height;
  } else {
    const double shift = rng.uniform(0, camera.width - (b.x2 - b.x1)) - b.x1;
    b.x1 += shift, b.x2 += shift;
  }
  if (camera.height > 0) b.y2 = std::min(b.y2, camera.height - 1.0);
  return b;
}

}  // namespace

void addFalseBoxes(double wetness, SensorFrame& frame, Rng& rng) {
  auto* detections = std::get_if<ObjectDetections>(&frame.data);
  if (!detections) return;
  const std::size_t seen = detections->objects.size();
  for (std::size_t i = 0; i < seen; ++i) {
    ObjectDetection d = detections->objects[i];
    if (!d.image_box) continue;
    for (int n = rng.poisson(wetness * (d.label == "Car" ? kCars : kPeople)); n > 0; --n) {
      ObjectDetection wrong;
      wrong.label = d.label;
      wrong.score = rng.uniform(kLeastScore, kMostScore);
      wrong.image_box = placed(*d.image_box, detections->camera, rng);
      wrong.heading = d.heading;
      if (wrong.image_box->y2 > wrong.image_box->y1) detections->objects.push_back(wrong);
    }
  }
}

}  // namespace perception
