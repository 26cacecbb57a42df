#include <algorithm>
#include <cmath>

#include "libperception/core/Error.h"
#include "libperception/packets/Bytes.h"
#include "libperception/packets/Encoder.h"
#include "libperception/packets/radars/CanBundle.h"
#include "libperception/packets/radars/Srr520.h"

namespace perception {
namespace {

/// A value in steps from a lowest one, within the bits there are.
std::uint32_t steps(double value, double scale, double offset, std::size_t bits) {
  const double most = static_cast<double>((1U << bits) - 1);
  return static_cast<std::uint32_t>(std::lround(std::clamp((value - offset) / scale, 0.0, most)));
}

/// The same in two's complement.
std::uint32_t signedSteps(double value, double scale, std::size_t bits) {
  const double most = static_cast<double>((1U << (bits - 1)) - 1);
  const auto whole = std::lround(std::clamp(value / scale, -most - 1, most));
  return static_cast<std::uint32_t>(whole) & ((1U << bits) - 1);
}

/// The returns that the device can express.
std::vector<RadarReturn> within(const std::vector<RadarReturn>& all, double range, double bearing) {
  std::vector<RadarReturn> out;
  for (const RadarReturn& r : all)
    if (r.range <= range && std::abs(r.bearing) <= bearing) out.push_back(r);
  return out;
}

/// A scan: status, 64 tracks, powers by ten groups; one message a track that is there.
class EsrEncoder final : public PacketEncoder {
 public:
  std::vector<TimedPacket> encode(const SensorFrame& frame, double) override {
    constexpr std::size_t kTracks = 64, kInGroup = 7, kGroups = 10;
    const auto returns = within(returnsOf(frame).returns, 204.7, 51.1 * M_PI / 180);
    std::vector<TimedPacket> packets;
    std::string status(8, '\0');
    putBig(status, 3, scan_++, 2);
    packets.push_back({0, canMessage(0x4E0, status)});
    for (std::uint32_t i = 0; i < kTracks; ++i)
      packets.push_back({0, canMessage(0x500 + i, i < returns.size() ? track(returns[i])
                                                                     : std::string(8, '\0'))});
    for (std::size_t g = 0; g < kGroups; ++g) {
      std::string powers(8, '\0');
      powers[0] = static_cast<char>(g);
      for (std::size_t i = 0; i < kInGroup && g * kInGroup + i < std::min(kTracks, returns.size());
           ++i)
        powers[1 + i] = static_cast<char>(steps(returns[g * kInGroup + i].amplitude, 1, -10, 5));
      packets.push_back({0, canMessage(0x540, powers)});
    }
    return packets;
  }

  void restart() override { scan_ = 0; }

 private:
  static std::string track(const RadarReturn& r) {
    std::string data(8, '\0');
    putBitsMsbFirst(data, 8, 3, 3);  // updated
    putBitsMsbFirst(data, 11, 10, signedSteps(-r.bearing * 180 / M_PI, .1, 10));
    putBitsMsbFirst(data, 21, 11, steps(r.range, .1, 0, 11));
    putBitsMsbFirst(data, 48, 2, 3);  // both modes
    putBitsMsbFirst(data, 50, 14, signedSteps(r.range_rate, .01, 14));
    return data;
  }

  std::uint16_t scan_ = 0;
};

/// A list of objects: its head, and a message each.
class Ars408Encoder final : public PacketEncoder {
 public:
  std::vector<TimedPacket> encode(const SensorFrame& frame, double) override {
    constexpr std::size_t kMost = 100;
    auto returns = within(returnsOf(frame).returns, 250, M_PI / 2);
    returns.resize(std::min(returns.size(), kMost));
    std::string head(4, '\0');
    head[0] = static_cast<char>(returns.size());
    putBig(head, 1, list_++, 2);
    std::vector<TimedPacket> packets{{0, canMessage(0x60A, head)}};
    for (std::size_t i = 0; i < returns.size(); ++i) {
      const RadarReturn& r = returns[i];
      const double c = std::cos(r.bearing), s = std::sin(r.bearing);
      std::string data(8, '\0');
      data[0] = static_cast<char>(i);
      putBitsMsbFirst(data, 8, 13, steps(r.range * c, .2, -500, 13));
      putBitsMsbFirst(data, 21, 11, steps(r.range * s, .2, -204.6, 11));
      putBitsMsbFirst(data, 32, 10, steps(r.range_rate * c, .25, -128, 10));
      putBitsMsbFirst(data, 42, 9, steps(r.range_rate * s, .25, -64, 9));
      putBitsMsbFirst(data, 56, 8, steps(r.amplitude, .5, -64, 8));
      packets.push_back({0, canMessage(0x60B, data)});
    }
    return packets;
  }

  void restart() override { list_ = 0; }

 private:
  std::uint16_t list_ = 0;
};

/// Detections in one datagram.
class Ars548Encoder final : public PacketEncoder {
 public:
  std::vector<TimedPacket> encode(const SensorFrame& frame, double) override {
    constexpr std::size_t kSize = 35336, kMost = 800, kFirst = 101, kDetection = 44;
    const auto& returns = returnsOf(frame).returns;
    const std::size_t count = std::min(returns.size(), kMost);
    std::string bytes(kSize, '\0');
    putBig(bytes, 2, 336, 2);
    putBig(bytes, 4, kSize - 8, 4);
    session_ = static_cast<std::uint16_t>(session_ % 65535 + 1);
    putBig(bytes, 10, session_, 2);
    bytes[12] = bytes[13] = 1;
    bytes[14] = 2;
    putBig(bytes, 36, static_cast<std::uint64_t>(frame.stamp.ns % 1000000000), 4);
    putBig(bytes, 40, static_cast<std::uint64_t>(frame.stamp.ns / 1000000000), 4);
    bytes[44] = 1;  // synchronized
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t at = kFirst + kDetection * i;
      putBigFloat(bytes, at, static_cast<float>(returns[i].bearing));
      putBigFloat(bytes, at + 9, static_cast<float>(returns[i].elevation.value_or(0)));
      putBigFloat(bytes, at + 17, static_cast<float>(returns[i].range));
      putBigFloat(bytes, at + 25, static_cast<float>(returns[i].range_rate));
      bytes[at + 33] =
          static_cast<char>(std::lround(std::clamp(returns[i].amplitude, -128.0, 127.0)));
    }
    putBig(bytes, 35309, count, 4);
    return {{0, bytes}};
  }

  void restart() override { session_ = 0; }

 private:
  std::uint16_t session_ = 0;
};

/// The near list: header, 50 elements, the message that closes it.
class Srr520Encoder final : public PacketEncoder {
 public:
  std::vector<TimedPacket> encode(const SensorFrame& frame, double) override {
    constexpr std::size_t kElements = 50, kIn = 10, kHeader = 32, kElement = 64;
    const auto returns = within(returnsOf(frame).returns, 100, M_PI / 2);
    const std::size_t count = std::min(returns.size(), kElements * kIn);
    std::string group(kHeader + kElements * kElement, '\0');
    putBig(group, 0, static_cast<std::uint64_t>(frame.stamp.ns / 1000) & 0xFFFFFFFF, 4);
    putBig(group, 4, static_cast<std::uint64_t>(frame.stamp.ns / 1000000000), 4);
    putBig(group, 8, static_cast<std::uint64_t>(frame.stamp.ns % 1000000000), 4);
    group[12] = 1;  // synchronized
    group[14] = static_cast<char>(scan_);
    putBig(group, 15, scan_++, 4);
    putBig(group, 23, count, 2);
    for (std::size_t i = 0; i < kElements; ++i) {
      group[kHeader + i * kElement + 62] = static_cast<char>(i);
      group[kHeader + i * kElement + 63] = group[14];
    }
    for (std::size_t i = 0; i < count; ++i)
      putTarget(group, 8 * (kHeader + i / kIn * kElement) + 48 * (i % kIn), returns[i]);
    std::string closing(4, '\0');
    putBig(closing, 1, srr520Checksum(group), 2);
    std::vector<TimedPacket> packets{{0, canMessage(900, group.substr(0, kHeader))}};
    for (std::size_t i = 0; i < kElements; ++i)
      packets.push_back({0, canMessage(901, group.substr(kHeader + i * kElement, kElement))});
    packets.push_back({0, canMessage(800, closing)});
    return packets;
  }

  void restart() override { scan_ = 0; }

 private:
  static void putTarget(std::string& group, std::size_t bit, const RadarReturn& r) {
    putBitsMsbFirst(group, bit, 12, steps(r.range, .024420024, 0, 12));
    putBitsMsbFirst(group, bit + 12, 9, steps(r.bearing, .006159986, -M_PI / 2, 9));
    putBitsMsbFirst(group, bit + 21, 11, steps(r.range_rate, .014662757, -15, 11));
    putBitsMsbFirst(group, bit + 32, 7, steps(r.amplitude, .476190476, -40, 7));
  }

  std::uint32_t scan_ = 0;
};

}  // namespace

const LidarCloud& PacketEncoder::cloudOf(const SensorFrame& frame) {
  const auto* cloud = std::get_if<LidarCloud>(&frame.data);
  if (!cloud) throw DataError(frame.sensor + ": a simulated lidar's packets need a lidar's scans");
  return *cloud;
}

const RadarReturns& PacketEncoder::returnsOf(const SensorFrame& frame) {
  const auto* returns = std::get_if<RadarReturns>(&frame.data);
  if (!returns)
    throw DataError(frame.sensor + ": a simulated radar's packets need a radar's scans");
  return *returns;
}

std::unique_ptr<PacketEncoder> makeEsrEncoder(const std::string&) {
  return std::make_unique<EsrEncoder>();
}

std::unique_ptr<PacketEncoder> makeArs408Encoder(const std::string&) {
  return std::make_unique<Ars408Encoder>();
}

std::unique_ptr<PacketEncoder> makeArs548Encoder(const std::string&) {
  return std::make_unique<Ars548Encoder>();
}

std::unique_ptr<PacketEncoder> makeSrr520Encoder(const std::string&) {
  return std::make_unique<Srr520Encoder>();
}

}  // namespace perception
