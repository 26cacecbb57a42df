#include "libperception/packets/lidars/RoboSense.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "libperception/core/Error.h"
#include "libperception/packets/Bytes.h"
#include "libperception/packets/Decoders.h"

namespace perception {

const RoboSenseModel kRs16{"RS-LiDAR-16", 1, 16, 55.5, 0.03825},
    kRs32{"RS-LiDAR-32", 2, 32, 55.52, 0.03997};

namespace {

using namespace std::string_view_literals;

// Of MSOP packets: header, blocks of an azimuth and 32 returns, a tail. [bytes]
constexpr auto kMsop = "\x55\xAA\x05\x0A\x5A\xA5\x50\xA0"sv;
constexpr std::size_t kStampAt = 20, kModelAt = 30, kRsHeader = 42, kRsBlock = 100;
constexpr std::size_t kRsBlocks = 12, kRsReturns = 32;
constexpr int kRsTurn = 36000;              ///< [0.01 deg]
constexpr int kWidestStep = 200;            ///< [0.01 deg] more is a field of view that is left out
constexpr double kRsUnit = 0.005;           ///< [m]
constexpr std::uint64_t kNoReturn = 65535;  ///< as 0
// Of DIFOP packets.
constexpr auto kDifop = "\xA5\xFF\x00\x5A\x11\x11\x55\x55"sv;
constexpr std::size_t kPitchesOf16 = 1165, kElevationsOf32 = 468, kAzimuthsOf32 = 564;
constexpr double kFromNominal = 2;  ///< [deg] (assumed) most of a unit's angle

bool beginsWith(std::string_view payload, std::string_view id) {
  return payload.size() == kRoboSenseSize && payload.substr(0, id.size()) == id;
}

/// Three bytes a laser [0.0001 deg]; the first eight look down.
std::vector<BeamAngles> pitchesOf16(std::string_view payload) {
  std::vector<BeamAngles> beams;
  for (std::size_t i = 0; i < kRs16.lasers; ++i) {
    const double angle = 1e-4 * static_cast<double>(bigEndian(payload, kPitchesOf16 + 3 * i, 3));
    beams.push_back({i < kRs16.lasers / 2 ? -angle : angle, 0});
    if (std::abs(beams[i].elevation - rs16Beams()[i].elevation) > kFromNominal) return {};
  }
  return beams;
}

/// A sign and two bytes a laser [0.001 or 0.01 deg, by the firmware]; empty: not set.
std::vector<double> anglesOf32(std::string_view payload, std::size_t from, double unit) {
  std::vector<double> angles;
  for (std::size_t at = from; angles.size() < kRs32.lasers; at += 3) {
    const auto sign = bigEndian(payload, at, 1);
    if (sign > 1) return {};
    const double angle = unit * static_cast<double>(bigEndian(payload, at + 1, 2));
    angles.push_back(sign == 1 ? -angle : angle);
  }
  return angles;
}

/// The lasers look from 25 deg down to 15 deg up: that tells the unit of the angles, too.
std::vector<BeamAngles> beamsOf32(std::string_view payload) {
  constexpr double kLowest = -25, kHighest = 15;  // [deg]
  for (const double unit : {0.001, 0.01}) {
    const auto elevations = anglesOf32(payload, kElevationsOf32, unit);
    const auto azimuths = anglesOf32(payload, kAzimuthsOf32, unit);
    if (elevations.empty() || azimuths.empty()) return {};
    const auto [low, high] = std::minmax_element(elevations.begin(), elevations.end());
    if (std::abs(*low - kLowest) > kFromNominal || std::abs(*high - kHighest) > kFromNominal)
      continue;
    std::vector<BeamAngles> beams;
    for (std::size_t i = 0; i < kRs32.lasers; ++i) beams.push_back({elevations[i], azimuths[i]});
    return beams;
  }
  return {};
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
    if (!model)
      refuse("byte 0: expected 55 AA 05 0A 5A A5 50 A0 (RS-LiDAR-16 and -32 alone are read)");
    const int other = kRs16.id + kRs32.id - model_.id;
    if (*model == other) refuse("byte 30: it is of model " + std::to_string(other));
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

  static std::int64_t stampOf(std::string_view payload) {
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
      const double range = static_cast<double>(raw) * kRsUnit;
      LidarReturn point = returnAt(range, angle + beams_[laser].azimuth, beams_[laser].elevation);
      const LidarReturn lens = returnAt(model_.lens, angle, 0);
      point.x += lens.x, point.y += lens.y;
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
  const auto i = static_cast<double>(laser % 16), pair = static_cast<double>(laser / 16);
  return id == kRs16.id ? 2.8 * i : 2.88 * i + 1.44 * pair;
}

bool isDifop(std::string_view payload) { return beginsWith(payload, kDifop); }

std::optional<int> robosenseModelIn(std::string_view payload) {
  if (!beginsWith(payload, kMsop)) return {};
  return static_cast<int>(bigEndian(payload, kModelAt, 1));
}

const std::vector<BeamAngles>& rs16Beams() {
  static const std::vector<BeamAngles> beams = [] {
    std::vector<BeamAngles> list;
    for (int i = 0; i < 8; ++i) list.push_back({2.0 * i - 15, 0});
    for (int i = 0; i < 8; ++i) list.push_back({15 - 2.0 * i, 0});
    return list;
  }();
  return beams;
}

std::vector<BeamAngles> beamsOfDifop(std::string_view payload, const RoboSenseModel& model) {
  if (!isDifop(payload)) return {};
  return model.id == kRs16.id ? pitchesOf16(payload) : beamsOf32(payload);
}

std::vector<BeamAngles> robosenseBeams(const std::string& file, const RoboSenseModel& model) {
  if (file.empty()) return model.id == kRs16.id ? rs16Beams() : std::vector<BeamAngles>();
  std::ifstream in(file, std::ios::binary);
  std::string bytes(kRoboSenseSize + 1, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(in.gcount(), 0)));
  if (!isDifop(bytes)) return readBeams(file, model.lasers);
  auto beams = beamsOfDifop(bytes, model);
  if (beams.empty())
    throw DataError(file + ": a DIFOP packet without angles of an " + std::string(model.name));
  return beams;
}

std::unique_ptr<PacketDecoder> makeRs16Decoder(const std::string& file) {
  return std::make_unique<RoboSenseDecoder>(kRs16, file);
}

std::unique_ptr<PacketDecoder> makeRs32Decoder(const std::string& file) {
  return std::make_unique<RoboSenseDecoder>(kRs32, file);
}

}  // namespace perception
