#include <array>
#include <cmath>
#include <optional>

#include "libperception/core/Error.h"
#include "libperception/packets/Bytes.h"
#include "libperception/packets/Decoders.h"
#include "libperception/packets/lidars/Beams.h"

namespace perception {
namespace {

constexpr std::size_t kSize = 1206, kBlock = 100, kTail = 1200, kBlocks = 12, kChannels = 32;
constexpr int kTurn = 36000;

/// Times of the manuals of each model.
struct Model {
  double unit;           ///< [m]
  double firing, laser;  ///< [us] of all lasers, and from one that fires to the next
  std::size_t together;  ///< lasers that fire at once
  std::vector<BeamAngles> beams;
  std::vector<std::uint16_t> rings;

  std::size_t firingsInBlock() const { return kChannels / beams.size(); }
  /// Of the return of a channel in its block [us].
  double timeInBlock(std::size_t channel) const {
    return firing * static_cast<double>(channel / beams.size()) +
           laser * static_cast<double>(channel % beams.size() / together);
  }
};

const Model& vlp16() {
  static const Model model{0.002, 55.296, 2.304, 1, vlp16Beams(), ringsOf(vlp16Beams())};
  return model;
}

const Model& vlp32c() {
  static const Model model{0.004, 55.296, 2.304, 2, vlp32cBeams(), ringsOf(vlp32cBeams())};
  return model;
}

const Model& hdl32e() {
  static const Model model{0.002, 46.08, 1.152, 1, hdl32eBeams(), ringsOf(hdl32eBeams())};
  return model;
}

const Model& modelIn(std::string_view payload) {
  const auto id = littleEndian(payload, kTail + 5, 1);
  if (id == 0x21) return hdl32e();
  if (id == 0x22) return vlp16();
  if (id == 0x28) return vlp32c();
  throw DataError("Velodyne packet: byte 1205: model " + std::to_string(id) +
                  ", expected 33 (HDL-32E), 34 (VLP-16) or 40 (VLP-32C)");
}

/// Azimuth of each block [0.01 deg].
std::array<int, kBlocks> azimuthsOf(std::string_view payload) {
  std::array<int, kBlocks> azimuths{};
  for (std::size_t b = 0; b < kBlocks; ++b) {
    if (littleEndian(payload, b * kBlock, 2) != 0xEEFF) {
      throw DataError("Velodyne packet: byte " + std::to_string(b * kBlock) +
                      ": block flag FF EE expected");
    }
    azimuths[b] = static_cast<int>(littleEndian(payload, b * kBlock + 2, 2));
    if (azimuths[b] >= kTurn) {
      throw DataError("Velodyne packet: block " + std::to_string(b) + ": azimuth " +
                      std::to_string(azimuths[b]) + ", expected below 36000");
    }
  }
  return azimuths;
}

class VelodyneDecoder final : public PacketDecoder {
 public:
  DecodedPacket decode(std::string_view payload) override {
    if (payload.size() != kSize) {
      throw DataError("Velodyne packet: " + std::to_string(payload.size()) +
                      " bytes, expected 1206");
    }
    const Model& model = modelIn(payload);
    const auto azimuths = azimuthsOf(payload);
    const std::size_t echoes = littleEndian(payload, kTail + 4, 1) == 0x39 ? 2 : 1;
    DecodedPacket packet;
    const auto micros = static_cast<std::int64_t>(littleEndian(payload, kTail, 4));
    packet.stamp_ns = micros * 1000;
    packet.clock_period_ns = kHour * 1000;
    const double firings = static_cast<double>(kBlocks * model.firingsInBlock() / echoes);
    packet.number = numberAt(micros, model.firing * firings, azimuths[0], packet);
    packet.numbers = std::uint64_t{1} << 32;
    packet.turn = static_cast<float>(azimuths[0]) / kTurn;
    for (std::size_t b = 0; b < kBlocks; ++b) {
      const std::size_t from = b + echoes < kBlocks ? b : b - echoes;  // the last: the step before
      const int step = (azimuths[from + echoes] - azimuths[from] + kTurn) % kTurn;
      addBlock(payload, model, b, echoes, azimuths[b], step, packet);
    }
    return packet;
  }

 private:
  /// From 0. Firings follow each other without a pause: how many packets lie between two stamps
  /// [us] is known. A clock that was set is no loss. Nor is certainly a gap of a good part of a
  /// turn: a field of view can be set, outside of which nothing is sent. It is told, once for gaps
  /// that are alike.
  std::uint64_t numberAt(std::int64_t micros, double period, int azimuth, DecodedPacket& packet) {
    if (!last_) {
      last_ = micros;
      return number_;
    }
    std::int64_t since = (micros - *last_) % kHour;
    if (since > kHour / 2) since -= kHour;
    if (since < -kHour / 2) since += kHour;
    const auto count = std::llround(static_cast<double>(since) / period);
    const double rest = static_cast<double>(since) - static_cast<double>(count) * period;
    const bool fits = std::abs(rest) < kJitter + kDrift * std::abs(static_cast<double>(since));
    const bool set_back = -static_cast<double>(since) > kLargeGap;
    if (fits && count <= 0 && !set_back)
      return (number_ - static_cast<std::uint64_t>(-count)) & 0xFFFFFFFF;
    last_ = micros;
    if (!fits || set_back) return ++number_;
    if (static_cast<double>(since) > kLargeGap) {
      tellGap(count - 1, azimuth, packet);
      return ++number_;
    }
    return number_ += static_cast<std::uint64_t>(count);
  }

  void tellGap(std::int64_t count, int azimuth, DecodedPacket& packet) {
    const bool again = std::abs(count - gap_) <= 2 && std::abs(azimuth - gap_end_) < 500;
    gap_ = count;
    gap_end_ = azimuth;
    if (again) return;
    packet.warnings.push_back(
        "Velodyne: " + std::to_string(count) + " packets missing by their stamps up to azimuth " +
        std::to_string(azimuth / 100) + " deg: lost, or outside of the field of view that is set");
  }

  static constexpr std::int64_t kHour = 3600000000;     ///< [us]
  static constexpr double kJitter = 60, kDrift = 1e-4;  ///< [us], [-] of the clock
  static constexpr double kLargeGap = 8000;             ///< [us] 30 deg at ten turns a second
  std::optional<std::int64_t> last_;                    ///< [us] of the newest packet
  std::uint64_t number_ = 0;
  std::int64_t gap_ = 0;
  int gap_end_ = 0;  ///< [0.01 deg]

  static void addBlock(std::string_view payload, const Model& model, std::size_t b,
                       std::size_t echoes, int azimuth, int step, DecodedPacket& packet) {
    const std::size_t lasers = model.beams.size(), echo = b % echoes;
    const double period = model.firing * static_cast<double>(model.firingsInBlock());
    for (std::size_t j = 0; j < kChannels; ++j) {
      const std::size_t at = b * kBlock + 4 + 3 * j;
      const auto raw = littleEndian(payload, at, 2);
      if (raw == 0 || (echo > 0 && payload.substr(at, 3) == payload.substr(at - kBlock, 3))) {
        continue;
      }
      const BeamAngles& beam = model.beams[j % lasers];
      const double after = model.timeInBlock(j);
      const double angle = (azimuth + step * after / period) / 100;
      LidarReturn point =
          returnAt(static_cast<double>(raw) * model.unit, angle + beam.azimuth, beam.elevation);
      point.intensity = static_cast<std::uint8_t>(payload[at + 2]);
      point.ring = model.rings[j % lasers];
      point.echo = static_cast<std::uint8_t>(echo);
      point.time_us = static_cast<float>(period * static_cast<double>(b / echoes) + after);
      packet.returns.push_back(point);
    }
  }
};

}  // namespace

std::unique_ptr<PacketDecoder> makeVelodyneDecoder() { return std::make_unique<VelodyneDecoder>(); }

}  // namespace perception
