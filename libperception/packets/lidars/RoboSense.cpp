#include "libperception/packets/lidars/RoboSense.h"

#include <algorithm>
#include <array>
#include <ctime>
#include <string>
#include <utility>
#include <vector>

#include "libperception/core/Error.h"
#include "libperception/packets/Bytes.h"
#include "libperception/packets/Decoders.h"

namespace perception {

const RoboSenseModel kRs16{"RS-LiDAR-16", 1, 16, 55.5, 0.03825},
    kRs32{"RS-LiDAR-32", 2, 32, 55.52, 0.03997},
    kHelios16{"RS-Helios-16P", kHeliosId, 16, 55.56, 0.03498, -60, 60, false, 0.0025},
    kHelios32{"RS-Helios-32", kHeliosId, 32, 55.56, 0.03498, -60, 60, false, 0.0025},
    kBpearl{"RS-Bpearl", 3, 32, 55.52, 0.01473, 0, 90, false, 0.005, 0.09427};

namespace {

using namespace std::string_view_literals;

// Of MSOP packets: header, blocks of an azimuth and 32 returns, a tail. [bytes]
constexpr auto kMsop = "\x55\xAA\x05\x0A\x5A\xA5\x50\xA0"sv;
constexpr auto kHeliosMsop = "\x55\xAA\x05\x5A"sv;
constexpr std::size_t kStampAt = 20, kHeliosStampAt = 10, kModelAt = 30, kVersionAt = 31,
                      kRsHeader = 42, kRsBlock = 100;
constexpr std::size_t kRsBlocks = 12, kRsReturns = 32;
constexpr int kRsTurn = 36000;              ///< [0.01 deg]
constexpr int kWidestStep = 200;            ///< [0.01 deg] more is a field of view that is left out
constexpr std::uint64_t kNoReturn = 65535;  ///< as 0
bool beginsWith(std::string_view payload, std::string_view id) {
  return payload.size() == kRoboSenseSize && payload.substr(0, id.size()) == id;
}

class RoboSenseDecoder final : public PacketDecoder {
 public:
  RoboSenseDecoder(const RoboSenseModel& model, const std::string& file) : model_(model) {
    setBeams(robosenseBeams(file, model));
  }

  DecodedPacket decode(std::string_view payload) override {
    if (isDifop(payload)) return takeDifop(payload);
    const auto azimuths = check(payload);
    DecodedPacket packet;
    if (beams_.empty()) {
      if (!std::exchange(told_, true))
        packet.warnings.push_back(std::string(model_.name) +
                                  ": returns are left out until a DIFOP packet has the angles of "
                                  "its beams; a file of them can be given");
      return packet;
    }
    packet.stamp_ns = stampOf(payload);
    packet.turn = static_cast<float>(azimuths[0]) / kRsTurn;
    const std::size_t echoes = isDual(azimuths) ? 2 : 1;
    int step = 0;
    for (std::size_t b = 0; b < kRsBlocks; ++b) {
      const std::size_t from = b + echoes < kRsBlocks ? b : b - echoes;
      const int next = (azimuths[from + echoes] - azimuths[from] + kRsTurn) % kRsTurn;
      if (next <= kWidestStep) step = next;
      addBlock(payload, b, echoes, azimuths[b], step, packet);
    }
    return packet;
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw DataError(std::string(model_.name) + " packet: " + what);
  }

  void setBeams(std::vector<BeamAngles> beams) {
    rings_ = ringsOf(beams);
    beams_ = std::move(beams);
  }

  DecodedPacket takeDifop(std::string_view payload) {
    DecodedPacket packet;
    auto beams = beamsOfDifop(payload, model_);
    if (!beams.empty()) {
      setBeams(std::move(beams));
    } else if (!std::exchange(told_difop_, true)) {
      packet.warnings.push_back("DIFOP packet: it has no angles of an " + std::string(model_.name) +
                                ": it is not used");
    }
    return packet;
  }

  /// Azimuth of each block [0.01 deg].
  std::array<int, kRsBlocks> check(std::string_view payload) const {
    if (payload.size() != kRoboSenseSize)
      refuse(std::to_string(payload.size()) + " bytes, expected 1248");
    const auto model = robosenseModelIn(payload);
    if (!model) refuse("byte 0: expected 55 AA 05 0A 5A A5 50 A0, or 55 AA 05 5A of a Helios");
    const bool known = *model == kRs16.id || *model == kRs32.id || *model == kBpearl.id;
    const bool helios = *model == kHeliosId;
    if (*model != model_.id && (known || helios || model_.id == kHeliosId))
      refuse(helios ? "byte 0: it is of a Helios"
                    : "byte 30: it is of model " + std::to_string(*model));
    constexpr std::uint64_t kOtherUnit = 4;
    if (model_.id == kBpearl.id && bigEndian(payload, kVersionAt, 1) == kOtherUnit)
      refuse("byte 31: it is of version 4, whose unit of distances is not known");
    std::array<int, kRsBlocks> azimuths{};
    for (std::size_t b = 0; b < kRsBlocks; ++b) {
      const std::size_t at = kRsHeader + b * kRsBlock;
      if (bigEndian(payload, at, 2) != 0xFFEE)
        refuse("byte " + std::to_string(at) + ": block flag FF EE expected");
      azimuths[b] = static_cast<int>(bigEndian(payload, at + 2, 2));
      if (azimuths[b] >= kRsTurn)
        refuse("block " + std::to_string(b) + ": azimuth " + std::to_string(azimuths[b]) +
               ", expected below 36000");
    }
    return azimuths;
  }

  std::int64_t stampOf(std::string_view payload) const {
    if (model_.id == kHeliosId)
      return static_cast<std::int64_t>(bigEndian(payload, kHeliosStampAt, 6)) * 1'000'000'000 +
             static_cast<std::int64_t>(bigEndian(payload, kHeliosStampAt + 6, 4)) * 1000;
    const auto field = [&](std::size_t i) {
      return static_cast<int>(bigEndian(payload, kStampAt + i, 1));
    };
    std::tm calendar{};
    calendar.tm_year = field(0) + 100;
    calendar.tm_mon = field(1) - 1;
    calendar.tm_mday = field(2);
    calendar.tm_hour = field(3);
    calendar.tm_min = field(4);
    calendar.tm_sec = field(5);
    const auto millis = static_cast<std::int64_t>(bigEndian(payload, kStampAt + 6, 2));
    const auto micros = static_cast<std::int64_t>(bigEndian(payload, kStampAt + 8, 2));
    return static_cast<std::int64_t>(timegm(&calendar)) * 1'000'000'000 + millis * 1'000'000 +
           micros * 1000;
  }

  /// Two returns of a firing are two blocks with one azimuth.
  static bool isDual(const std::array<int, kRsBlocks>& azimuths) {
    for (std::size_t b = 0; b < kRsBlocks; b += 2) {
      if (azimuths[b] != azimuths[b + 1]) return false;
    }
    return azimuths[0] != azimuths[2];
  }

  void addBlock(std::string_view payload, std::size_t b, std::size_t echoes, int azimuth, int step,
                DecodedPacket& packet) const {
    const double period = model_.firing * static_cast<double>(kRsReturns / model_.lasers);
    const std::size_t echo = b % echoes;
    for (std::size_t j = 0; j < kRsReturns; ++j) {
      const std::size_t at = kRsHeader + b * kRsBlock + 4 + 3 * j, laser = j % model_.lasers;
      const auto raw = bigEndian(payload, at, 2);
      if (raw == 0 || raw == kNoReturn) continue;
      if (echo > 0 && payload.substr(at, 3) == payload.substr(at - kRsBlock, 3)) continue;
      const double after =
          model_.firing * static_cast<double>(j / model_.lasers) + model_.laserTime(laser);
      const double angle = (azimuth + step * after / period) / 100;
      const double range = static_cast<double>(raw) * model_.unit;
      LidarReturn point = returnAt(range, angle + beams_[laser].azimuth, beams_[laser].elevation);
      const LidarReturn lens = returnAt(model_.lens, angle, 0);
      point.x += lens.x, point.y += lens.y, point.z += static_cast<float>(model_.lens_height);
      point.intensity = static_cast<std::uint8_t>(payload[at + 2]);
      point.ring = rings_[laser];
      point.echo = static_cast<std::uint8_t>(echo);
      point.time_us = static_cast<float>(period * static_cast<double>(b / echoes) + after);
      packet.returns.push_back(point);
    }
  }

  const RoboSenseModel& model_;
  std::vector<BeamAngles> beams_;
  std::vector<std::uint16_t> rings_;
  bool told_ = false, told_difop_ = false;
};

}  // namespace

double RoboSenseModel::laserTime(std::size_t laser) const {
  static constexpr double kOfHelios[] = {0,     1.57,  3.15,  4.72,  6.30,  7.87,  9.45,  11.36,
                                         13.26, 15.17, 17.08, 18.99, 20.56, 22.14, 23.71, 25.29,
                                         26.53, 29.01, 27.77, 30.25, 31.49, 33.98, 32.73, 35.22,
                                         36.46, 37.70, 38.94, 40.18, 41.42, 42.67, 43.91, 45.15};
  if (id == kHeliosId) return kOfHelios[laser % lasers * (32 / lasers)];
  const auto i = static_cast<double>(laser % 16), pair = static_cast<double>(laser / 16);
  if (id == kBpearl.id) return 2.56 * i + (laser % 16 < 8 ? 0 : 5.2) + 1.28 * pair;
  return id == kRs16.id ? 2.8 * i : 2.88 * i + 1.44 * pair;
}

std::optional<int> robosenseModelIn(std::string_view payload) {
  if (beginsWith(payload, kHeliosMsop)) return kHeliosId;
  if (!beginsWith(payload, kMsop)) return {};
  return static_cast<int>(bigEndian(payload, kModelAt, 1));
}

std::unique_ptr<PacketDecoder> makeRs16Decoder(const std::string& file) {
  return std::make_unique<RoboSenseDecoder>(kRs16, file);
}

std::unique_ptr<PacketDecoder> makeRs32Decoder(const std::string& file) {
  return std::make_unique<RoboSenseDecoder>(kRs32, file);
}

std::unique_ptr<PacketDecoder> makeHelios16Decoder(const std::string& file) {
  return std::make_unique<RoboSenseDecoder>(kHelios16, file);
}

std::unique_ptr<PacketDecoder> makeHelios32Decoder(const std::string& file) {
  return std::make_unique<RoboSenseDecoder>(kHelios32, file);
}

std::unique_ptr<PacketDecoder> makeBpearlDecoder(const std::string& file) {
  return std::make_unique<RoboSenseDecoder>(kBpearl, file);
}

}  // namespace perception
