#include "libperception/packets/lidars/Ibeo.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/Error.h"
#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/packets/Bytes.h"
#include "libperception/packets/Decoders.h"
#include "libperception/packets/lidars/Beams.h"

namespace perception {
namespace {

constexpr std::uint32_t kMagic = 0xAFFEC0C2, kOldMagic = 0xAFFEC0C0;
constexpr std::size_t kHeader = 24, kOldHeader = 16, kLargest = 4 << 20;
constexpr std::uint64_t kUnixIn1900 = 2208988800;
constexpr std::size_t kLuxBody = 44, kLuxPoint = 10;
constexpr std::size_t kEcuBody = 24, kEcuPoint = 28, kInfo2204 = 40, kInfo2205 = 148;
constexpr std::size_t kOldBody = 16, kOldPoint = 12;
constexpr std::uint64_t kLabeled = 7;  ///< flags of a scan: ground, dirt, rain are labeled

[[noreturn]] void refuseIbeo(const std::string& what) { throw DataError("Ibeo message: " + what); }

void expectPoints(std::string_view body, std::size_t first, std::size_t count, std::size_t size) {
  if (first + count * size > body.size())
    refuseIbeo(std::to_string(count) + " points do not fit in " + std::to_string(body.size()) +
               " bytes");
}

int signed16(std::uint64_t value) { return static_cast<std::int16_t>(value); }

std::uint8_t labelOf(bool ground, bool dirt, bool rain, bool labeled) {
  const PointLabel label = ground    ? PointLabel::kGround
                           : dirt    ? PointLabel::kDirt
                           : rain    ? PointLabel::kRain
                           : labeled ? PointLabel::kObject
                                     : PointLabel::kUnknown;
  return static_cast<std::uint8_t>(label);
}

DecodedPacket scanOf(std::uint64_t number, std::int64_t stamp_ns) {
  DecodedPacket packet;
  packet.number = number;
  packet.numbers = 65536;
  packet.stamp_ns = stamp_ns;
  packet.ends_scan = packet.labeled = true;
  return packet;
}

/// A scan of one LUX, little endian; stamped at its end, as it is sent.
DecodedPacket luxScan(std::string_view body) {
  if (body.size() < kLuxBody) refuseIbeo("2202: " + std::to_string(body.size()) + " bytes");
  const auto u16 = [&](std::size_t at) { return littleEndian(body, at, 2); };
  const std::size_t count = u16(28);
  expectPoints(body, kLuxBody, count, kLuxPoint);
  const auto ticks = static_cast<double>(u16(22));
  if (ticks == 0) refuseIbeo("2202: byte 22: 0 ticks a turn");
  const std::int64_t begin = stampOfNtp(littleEndian(body, 6, 8));
  DecodedPacket packet = scanOf(u16(0), stampOfNtp(littleEndian(body, 14, 8)));
  const std::uint64_t flags = u16(42);
  packet.clock = (u16(2) & 0x20) != 0 ? ClockState::kSynchronized : ClockState::kNeverSet;
  const int from = signed16(u16(24)), to = signed16(u16(26));
  const std::int64_t took = packet.stamp_ns - begin;
  const double per_tick = from == to || took < 0 || took > 1000000000
                              ? 0
                              : static_cast<double>(took) * 1e-3 / (to - from);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = kLuxBody + kLuxPoint * i;
    const auto layer = littleEndian(body, at, 1) & 15, point_flags = littleEndian(body, at + 1, 1);
    if (layer >= std::size(kIbeoLayers))
      refuseIbeo("2202: point " + std::to_string(i) + ": layer " + std::to_string(layer));
    const int angle = signed16(u16(at + 2));
    LidarReturn point =
        returnAt(.01 * static_cast<double>(u16(at + 4)), -360 * angle / ticks, kIbeoLayers[layer]);
    point.ring = static_cast<std::uint16_t>(layer);
    point.echo = static_cast<std::uint8_t>(littleEndian(body, at, 1) >> 4);
    point.pulse_width = static_cast<float>(.01 * static_cast<double>(u16(at + 6)));
    point.label = labelOf((point_flags & 4) != 0, (point_flags & 8) != 0, (point_flags & 2) != 0,
                          (flags & kLabeled) != 0);
    point.time_us = static_cast<float>(per_tick * (angle - to));
    packet.returns.push_back(point);
  }
  return packet;
}

/// A scan of an ECU, big endian: points in space, of one or more scanners.
DecodedPacket ecuScan(std::string_view body, std::size_t info) {
  if (body.size() < kEcuBody) refuseIbeo("ECU scan: " + std::to_string(body.size()) + " bytes");
  const auto u16 = [&](std::size_t at) { return bigEndian(body, at, 2); };
  const std::size_t count = u16(18), first = kEcuBody + info * bigEndian(body, 20, 1);
  expectPoints(body, first, count, kEcuPoint);
  const auto took = static_cast<std::int64_t>(bigEndian(body, 8, 4));  // [us]
  DecodedPacket packet = scanOf(u16(16), stampOfNtp(bigEndian(body, 0, 8)) + took * 1000);
  const std::uint64_t flags = bigEndian(body, 12, 4);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = first + kEcuPoint * i;
    LidarReturn point;
    point.x = bigEndianFloat(body, at);
    point.y = bigEndianFloat(body, at + 4);
    point.z = bigEndianFloat(body, at + 8);
    point.pulse_width = bigEndianFloat(body, at + 12);
    if (!std::isfinite(point.x) || !std::isfinite(point.y) || !std::isfinite(point.z) ||
        !std::isfinite(point.pulse_width))
      refuseIbeo("ECU scan: point " + std::to_string(i) + " is not finite");
    point.ring = static_cast<std::uint16_t>(bigEndian(body, at + 17, 1));
    point.echo = static_cast<std::uint8_t>(body[at + 18]);
    point.time_us =
        static_cast<float>(static_cast<std::int64_t>(bigEndian(body, at + 20, 4)) - took);
    const std::uint64_t point_flags = u16(at + 24);
    point.label = labelOf((point_flags & 1) != 0, (point_flags & 2) != 0, (point_flags & 4) != 0,
                          (flags & kLabeled) != 0);
    packet.returns.push_back(point);
  }
  return packet;
}

/// [m]; beyond 100 m in steps of .1 m.
float oldLength(int value) {
  if (value > 10000) return static_cast<float>(.1 * value - 900);
  if (value < -10000) return static_cast<float>(.1 * value + 900);
  return static_cast<float>(.01 * value);
}

/// A scan of the ALASCA XT, with the old header; its time is that since it was switched on [ms].
DecodedPacket alascaScan(std::string_view message) {
  const auto size = bigEndian(message, 4, 4);
  if (size != message.size() - kOldHeader)
    refuseIbeo("byte 4: " + std::to_string(size) + " bytes of body, " +
               std::to_string(message.size() - kOldHeader) + " came");
  if (bigEndian(message, 8, 4) != 15) return {};  // no scan
  const std::string_view body = message.substr(kOldHeader);
  if (body.size() < kOldBody) refuseIbeo("ALASCA: " + std::to_string(body.size()) + " bytes");
  const std::size_t count = bigEndian(body, 14, 2);
  expectPoints(body, kOldBody, count, kOldPoint);
  DecodedPacket packet =
      scanOf(bigEndian(body, 12, 2), static_cast<std::int64_t>(bigEndian(body, 4, 4)) * 1000000);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = kOldBody + kOldPoint * i;
    const auto status = bigEndian(body, at + 3, 1);
    if (status == 1) continue;  // not valid
    const auto length = [&](std::size_t o) {
      return oldLength(signed16(bigEndian(body, at + o, 2)));
    };
    LidarReturn point;
    point.x = length(4);
    point.y = length(6);
    point.z = length(8);
    point.pulse_width = static_cast<float>(.01 * static_cast<double>(bigEndian(body, at + 10, 2)));
    point.ring = static_cast<std::uint16_t>(bigEndian(body, at + 1, 1));
    point.echo = static_cast<std::uint8_t>(body[at + 2]);
    point.label = labelOf(status == 3, status == 4, status == 2, true);
    packet.returns.push_back(point);
  }
  return packet;
}

/// Whether a whole header stands here: magic number, a type that there is, a size within reason.
bool isHeader(std::string_view bytes) {
  const auto magic = bigEndian(bytes, 0, 4), type = bigEndian(bytes, 14, 2);
  if (magic == kOldMagic) return bigEndian(bytes, 4, 4) <= kLargest && bigEndian(bytes, 8, 4) < 256;
  return magic == kMagic && bigEndian(bytes, 8, 4) <= kLargest && type >> 12 == 2;
}

class IbeoDecoder final : public PacketDecoder {
 public:
  DecodedPacket decode(std::string_view message) override {
    if (message.size() < kOldHeader)
      refuseIbeo(std::to_string(message.size()) + " bytes, no header");
    if (bigEndian(message, 0, 4) == kOldMagic) return alascaScan(message);
    if (bigEndian(message, 0, 4) != kMagic) refuseIbeo("byte 0: AF FE C0 C2 expected");
    if (message.size() < kHeader) refuseIbeo(std::to_string(message.size()) + " bytes, no header");
    const auto size = bigEndian(message, 8, 4);
    if (size != message.size() - kHeader)
      refuseIbeo("byte 8: " + std::to_string(size) + " bytes of body, " +
                 std::to_string(message.size() - kHeader) + " came");
    const std::string_view body = message.substr(kHeader);
    switch (static_cast<IbeoType>(bigEndian(message, 14, 2))) {
      case IbeoType::kLuxScan:
        return luxScan(body);
      case IbeoType::kEcuScan2204:
        return ecuScan(body, kInfo2204);
      case IbeoType::kEcuScan:
        return ecuScan(body, kInfo2205);
    }
    return {};  // errors, objects of its own tracker, answers to commands
  }
};

}  // namespace

std::uint64_t ntpOf(std::int64_t stamp_ns) {
  const auto ns = static_cast<std::uint64_t>(stamp_ns);
  const std::uint64_t fraction = (((ns % 1000000000) << 32) + 500000000) / 1000000000;
  return (((ns / 1000000000 + kUnixIn1900) & 0xFFFFFFFF) << 32) + fraction;
}

std::int64_t stampOfNtp(std::uint64_t ntp) {
  const std::uint64_t nanoseconds = ((ntp & 0xFFFFFFFF) * 1000000000 + (1ULL << 31)) >> 32;
  return (static_cast<std::int64_t>(ntp >> 32) - static_cast<std::int64_t>(kUnixIn1900)) *
             1000000000 +
         static_cast<std::int64_t>(nanoseconds);
}

std::string ibeoMessage(IbeoType type, std::int64_t stamp_ns, std::uint32_t previous_size,
                        std::string_view body) {
  std::string message(kHeader, '\0');
  putBig(message, 0, kMagic, 4);
  putBig(message, 4, previous_size, 4);
  putBig(message, 8, body.size(), 4);
  putBig(message, 14, static_cast<std::uint64_t>(type), 2);
  putBig(message, 16, ntpOf(stamp_ns), 8);
  message += body;
  return message;
}

std::vector<std::string> IbeoStream::add(std::string_view bytes) {
  rest_ += bytes;
  std::vector<std::string> messages;
  std::size_t at = 0;
  for (;;) {
    const std::size_t begin = std::min(rest_.find("\xAF\xFE\xC0", at), rest_.size());
    // What may be the first two bytes of the next one stays.
    const std::size_t skip =
        begin == rest_.size() ? rest_.size() - std::min<std::size_t>(2, rest_.size() - at) : begin;
    skipped_ += skip - at;
    at = skip;
    if (begin == rest_.size() || rest_.size() - at < kOldHeader) break;
    const std::string_view here = std::string_view(rest_).substr(at);
    const auto magic = bigEndian(here, 0, 4);
    const bool old = magic == kOldMagic;
    const std::size_t size =
        (old ? kOldHeader + bigEndian(here, 4, 4) : kHeader + bigEndian(here, 8, 4));
    if ((magic != kMagic && !old) || size > kLargest) {
      ++at, ++skipped_;  // no beginning after all
      continue;
    }
    // A message that was cut holds the next one's beginning: that one is not lost with it.
    const std::size_t next = here.substr(0, size).find("\xAF\xFE\xC0", 3);
    const bool found = next != std::string_view::npos;
    if (found && here.size() - next < kHeader) break;
    if (found && isHeader(here.substr(next))) {
      messages.emplace_back(here.substr(0, next));
      at += next;
      continue;
    }
    if (here.size() < size) break;
    messages.emplace_back(here.substr(0, size));
    at += size;
  }
  rest_.erase(0, at);
  return messages;
}

std::unique_ptr<PacketDecoder> makeIbeoDecoder() { return std::make_unique<IbeoDecoder>(); }

}  // namespace perception
