#include "libperception/pipeline/health/FrozenPicture.h"

#include <cstring>

namespace perception {
namespace {

// All assumed.
constexpr double kFrozenFor = 1, kFrozenWay = 2;  // [s], [m]
constexpr std::size_t kFrozenFrames = 5;          // frames
constexpr std::size_t kPrintEvery = 61;           // of a lidar's returns

/// FNV-1a over the bits of numbers.
class Fingerprint {
 public:
  void add(double value) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof(bits));
    value_ = (value_ ^ bits) * 1099511628211ULL;
    value_ ^= value_ >> 32;
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 14695981039346656037ULL;
};

void add(const ObjectDetection& o, Fingerprint& print) {
  print.add(o.score);
  if (const auto& b = o.image_box)
    print.add(b->x1), print.add(b->y1), print.add(b->x2), print.add(b->y2);
  if (const auto& b = o.space_box)
    print.add(b->bottom_center.x()), print.add(b->bottom_center.y()), print.add(b->yaw);
}

}  // namespace

std::uint64_t FrozenPicture::fingerprint(const SensorFrame& frame) {
  Fingerprint print;
  if (const auto* cloud = std::get_if<LidarCloud>(&frame.data)) {
    if (cloud->size() == 0) return 0;
    print.add(static_cast<double>(cloud->size()));
    for (std::size_t k = 0; k < cloud->size(); k += kPrintEvery)
      print.add(static_cast<double>(cloud->x[k])), print.add(static_cast<double>(cloud->y[k]));
  } else if (const auto* radar = std::get_if<RadarReturns>(&frame.data)) {
    if (radar->returns.empty()) return 0;
    for (const RadarReturn& r : radar->returns)
      print.add(r.range), print.add(r.bearing), print.add(r.range_rate), print.add(r.amplitude);
  } else if (const auto* boxes = std::get_if<ObjectDetections>(&frame.data)) {
    if (boxes->objects.empty()) return 0;
    for (const ObjectDetection& o : boxes->objects) perception::add(o, print);
  } else {
    return 0;
  }
  return print.value() | 1;
}

void FrozenPicture::add(const SensorFrame& frame) {
  const std::uint64_t print = fingerprint(frame);
  last_ = frame.stamp, at_ = frame.ego.T_world_ego.translation().head<2>();
  if (print != 0 && print == print_) {
    ++repeated_;
    return;
  }
  print_ = print, repeated_ = 0, first_ = last_, from_ = at_;
}

std::optional<FrozenPicture::Frozen> FrozenPicture::frozen() const {
  const double seconds = last_ - first_, meters = (at_ - from_).norm();
  if (repeated_ < kFrozenFrames || seconds < kFrozenFor || meters < kFrozenWay) return std::nullopt;
  return Frozen{seconds, meters};
}

}  // namespace perception
