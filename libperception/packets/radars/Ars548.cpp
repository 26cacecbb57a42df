#include <cmath>
#include <string>

#include "libperception/core/Error.h"
#include "libperception/packets/Bytes.h"
#include "libperception/packets/Decoders.h"

namespace perception {
namespace {

constexpr std::size_t kDetections = 35336, kDetection = 44, kMostDetections = 800;
constexpr std::size_t kObject = 187, kFirstDetection = 101, kFirstObject = 51;

[[noreturn]] void refuseArs548(const std::string& what) {
  throw DataError("ARS548 message: " + what);
}

PacketTarget detectionAt(std::string_view bytes, std::size_t at) {
  const auto f = [&](std::size_t offset) { return bigEndianFloat(bytes, at + offset); };
  PacketTarget target;
  target.azimuth = f(0);
  target.elevation = f(9);
  target.has_elevation = true;
  target.range = f(17);
  target.range_rate = f(25);
  target.rcs = static_cast<std::int8_t>(bytes[at + 33]);
  return target;
}

RadarObject objectAt(std::string_view bytes, std::size_t at) {
  const auto f = [&](std::size_t offset) { return bigEndianFloat(bytes, at + offset); };
  RadarObject object;
  object.id = static_cast<std::uint32_t>(bigEndian(bytes, at + 2, 4));
  object.x = f(13);
  object.y = f(21);
  object.z = f(29);
  object.yaw = f(41);
  object.vx = f(90);  // after the flag of the group of relative velocity
  object.vy = f(98);
  object.length = f(166);
  object.width = f(179);
  return object;
}

/// Whether range, azimuth, elevation and rate are valid and finite.
bool usable(std::string_view bytes, std::size_t at, const PacketTarget& target) {
  constexpr int kValues = 0x55;  // the other bits are of the standard deviations
  return (static_cast<std::uint8_t>(bytes[at + 8]) & kValues) == 0 && std::isfinite(target.range) &&
         target.range >= 0 && std::isfinite(target.azimuth) && std::isfinite(target.elevation) &&
         std::isfinite(target.range_rate);
}

void addDetections(std::string_view payload, DecodedPacket& packet) {
  if (payload.size() != kDetections)
    refuseArs548(std::to_string(payload.size()) + " bytes of detections, expected 35336");
  const auto count = bigEndian(payload, 35309, 4);
  if (count > kMostDetections) refuseArs548(std::to_string(count) + " detections, at most 800");
  std::size_t left_out = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t at = kFirstDetection + kDetection * k;
    const PacketTarget target = detectionAt(payload, at);
    if (usable(payload, at, target)) {
      packet.targets.push_back(target);
    } else {
      ++left_out;
    }
  }
  if (left_out > 0)
    packet.warnings.push_back("ARS548: " + std::to_string(left_out) + " detections not valid");
  packet.ends_scan = true;
  const auto session = bigEndian(payload, 10, 2);  // runs from 1 to 65535; 0: not numbered
  if (session == 0) return;
  packet.number = session - 1;
  packet.numbers = 65535;
}

void addObjects(std::string_view payload, DecodedPacket& packet) {
  const auto count = bigEndian(payload, 50, 1);
  const std::size_t most = payload.size() == 9401 ? 50 : payload.size() == 37452 ? 200 : 0;
  if (most == 0)
    refuseArs548(std::to_string(payload.size()) + " bytes of objects, expected 9401 or 37452");
  if (count > most)
    refuseArs548(std::to_string(count) + " objects, at most " + std::to_string(most));
  for (std::size_t k = 0; k < count; ++k) {
    packet.objects.push_back(objectAt(payload, kFirstObject + kObject * k));
  }
}

class Ars548Decoder final : public PacketDecoder {
 public:
  DecodedPacket decode(std::string_view payload) override {
    const std::string size = std::to_string(payload.size()) + " bytes";
    if (payload.size() < kFirstObject) refuseArs548(size + ", shorter than its header");
    if (bigEndian(payload, 4, 4) != payload.size() - 8)
      refuseArs548("byte 4: length is not that of " + size);
    DecodedPacket packet;
    packet.stamp_ns = static_cast<std::int64_t>(bigEndian(payload, 40, 4)) * 1000000000 +
                      static_cast<std::int64_t>(bigEndian(payload, 36, 4));
    const auto sync = bigEndian(payload, 44, 1);
    packet.clock = sync == 1   ? ClockState::kSynchronized
                   : sync == 3 ? ClockState::kLost
                               : ClockState::kNeverSet;
    const auto method = bigEndian(payload, 2, 2);
    if (method == 336) {
      addDetections(payload, packet);
    } else if (method == 329) {
      addObjects(payload, packet);
    } else {
      refuseArs548("method " + std::to_string(method) + ", expected 336 or 329");
    }
    return packet;
  }
};

}  // namespace

std::unique_ptr<PacketDecoder> makeArs548Decoder() { return std::make_unique<Ars548Decoder>(); }

}  // namespace perception
