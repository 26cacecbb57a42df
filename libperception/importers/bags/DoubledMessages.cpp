#include "libperception/importers/bags/DoubledMessages.h"

#include <cmath>
#include <functional>
#include <iterator>
#include <string_view>
#include <variant>

namespace perception {
namespace {

constexpr std::size_t kLeastTellingReturns = 100;  // (assumed) the same numbers are no chance

template <class Number>
void mix(std::size_t& hash, const Number* numbers, std::size_t count) {
  const std::string_view bytes(reinterpret_cast<const char*>(numbers), count * sizeof(Number));
  hash = hash * 1'000'003 + std::hash<std::string_view>()(bytes);
}

/// A hash of what the sensor said.
std::size_t contentOf(const SensorFrame& frame) {
  std::size_t hash = 0;
  if (const auto* cloud = std::get_if<LidarCloud>(&frame.data)) {
    for (const auto* values : {&cloud->x, &cloud->y, &cloud->z, &cloud->intensity})
      mix(hash, values->data(), values->size());
  } else if (const auto* radar = std::get_if<RadarReturns>(&frame.data)) {
    for (const RadarReturn& r : radar->returns) {
      const double numbers[] = {r.range, r.bearing, r.range_rate, r.amplitude,
                                static_cast<double>(r.id)};
      mix(hash, numbers, 5);
    }
  } else if (const auto* found = std::get_if<ObjectDetections>(&frame.data)) {
    for (const ObjectDetection& o : found->objects) {
      mix(hash, o.label.data(), o.label.size());
      mix(hash, &o.score, 1);
      if (o.image_box) mix(hash, &o.image_box->x1, 1), mix(hash, &o.image_box->y1, 1);
      if (o.space_box) mix(hash, o.space_box->bottom_center.data(), 3);
    }
  }
  return hash;
}

}  // namespace

bool DoubledMessages::isDouble(const SensorFrame& frame, double resent) {
  if (std::holds_alternative<CameraImage>(frame.data)) return false;
  Said& said = said_[frame.sensor];
  for (auto it = said.begin(); it != said.end();)
    it = std::abs(frame.stamp - it->second) > resent ? said.erase(it) : std::next(it);
  const auto [before, first] = said.emplace(contentOf(frame), frame.stamp);
  const auto* const cloud = std::get_if<LidarCloud>(&frame.data);
  const bool tells = cloud != nullptr && cloud->size() >= kLeastTellingReturns;
  const bool again = !first && (tells || before->second == frame.stamp);
  if (again) ++counts_[frame.sensor];
  before->second = frame.stamp;
  return again;
}

}  // namespace perception
