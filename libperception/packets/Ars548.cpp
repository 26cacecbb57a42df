#include "libperception/packets/Ars548.h"

#include <string>

#include "libperception/core/Error.h"
#include "libperception/packets/Bytes.h"

namespace perception {
namespace {

constexpr std::size_t kDetections = 35336, kDetection = 44, kMostDetections = 800;
constexpr std::size_t kObject = 187, kFirstDetection = 101, kFirstObject = 51;

[[noreturn]] void refuse(const std::string& what) { throw DataError("ARS548 message: " + what); }

Ars548Detection detectionAt(std::string_view bytes, std::size_t at) {
  const auto f = [&](std::size_t offset) { return bigEndianFloat(bytes, at + offset); };
  Ars548Detection d;
  d.azimuth = f(0);
  d.azimuth_sd = f(4);
  d.invalid = static_cast<std::uint8_t>(bytes[at + 8]);
  d.elevation = f(9);
  d.elevation_sd = f(13);
  d.range = f(17);
  d.range_sd = f(21);
  d.range_rate = f(25);
  d.range_rate_sd = f(29);
  d.rcs = static_cast<std::int8_t>(bytes[at + 33]);
  return d;
}

Ars548Object objectAt(std::string_view bytes, std::size_t at) {
  const auto f = [&](std::size_t offset) { return bigEndianFloat(bytes, at + offset); };
  Ars548Object object;
  object.id = static_cast<std::uint32_t>(bigEndian(bytes, at + 2, 4));
  object.x = f(13);
  object.y = f(21);
  object.z = f(29);
  object.yaw = f(41);
  object.vx = f(90);  // after the group's flag
  object.vy = f(98);
  object.length = f(166);
  object.width = f(179);
  return object;
}

}  // namespace

Ars548Message decodeArs548(std::string_view payload) {
  const std::string size = std::to_string(payload.size()) + " bytes";
  if (payload.size() < kFirstObject) refuse(size + ", shorter than its header");
  if (bigEndian(payload, 4, 4) != payload.size() - 8)
    refuse("byte 4: length is not that of " + size);
  Ars548Message message;
  message.stamp_ns = static_cast<std::int64_t>(bigEndian(payload, 40, 4)) * 1000000000 +
                     static_cast<std::int64_t>(bigEndian(payload, 36, 4));
  message.synchronized = payload[44] == 1;
  const auto method = bigEndian(payload, 2, 2);
  if (method == 336) {
    if (payload.size() != kDetections) refuse(size + " of detections, expected 35336");
    const auto count = bigEndian(payload, 35309, 4);
    if (count > kMostDetections) refuse(std::to_string(count) + " detections, at most 800");
    for (std::size_t k = 0; k < count; ++k) {
      message.detections.push_back(detectionAt(payload, kFirstDetection + kDetection * k));
    }
  } else if (method == 329) {
    const auto count = bigEndian(payload, 50, 1);
    const std::size_t most = payload.size() == 9401 ? 50 : payload.size() == 37452 ? 200 : 0;
    if (most == 0) refuse(size + " of objects, expected 9401 or 37452");
    if (count > most) refuse(std::to_string(count) + " objects, at most " + std::to_string(most));
    for (std::size_t k = 0; k < count; ++k) {
      message.objects.push_back(objectAt(payload, kFirstObject + kObject * k));
    }
  } else {
    refuse("method " + std::to_string(method) + ", expected 336 or 329");
  }
  return message;
}

}  // namespace perception
