#include <array>

#include "libperception/core/Error.h"
#include "libperception/packets/Beams.h"
#include "libperception/packets/Bytes.h"
#include "libperception/packets/Decoders.h"

namespace perception {
namespace {

constexpr std::size_t kSize = 1206, kBlock = 100, kTail = 1200, kBlocks = 12, kChannels = 32;
constexpr int kTurn = 36000;
constexpr double kFiring = 55.296, kLaser = 2.304;  ///< [us]

struct Model {
  double unit;  ///< [m]
  std::vector<BeamAngles> beams;
  std::vector<std::uint16_t> rings;
};

Model modelOf(double unit, const std::vector<BeamAngles>& beams) {
  return {unit, beams, ringsOf(beams)};
}

const Model& vlp16() {
  static const Model model = modelOf(0.002, {{-15, 0},
                                             {1, 0},
                                             {-13, 0},
                                             {3, 0},
                                             {-11, 0},
                                             {5, 0},
                                             {-9, 0},
                                             {7, 0},
                                             {-7, 0},
                                             {9, 0},
                                             {-5, 0},
                                             {11, 0},
                                             {-3, 0},
                                             {13, 0},
                                             {-1, 0},
                                             {15, 0}});
  return model;
}

const Model& vlp32c() {
  static const Model model = modelOf(
      0.004,
      {{-25, 1.4},    {-1, -4.2},     {-1.667, 1.4}, {-15.639, -1.4}, {-11.31, 1.4}, {0, -1.4},
       {-.667, 4.2},  {-8.843, -1.4}, {-7.254, 1.4}, {.333, -4.2},    {-.333, 1.4},  {-6.148, -1.4},
       {-5.333, 4.2}, {1.333, -1.4},  {.667, 4.2},   {-4, -1.4},      {-4.667, 1.4}, {1.667, -4.2},
       {1, 1.4},      {-3.667, -4.2}, {-3.333, 4.2}, {3.333, -1.4},   {2.333, 1.4},  {-2.667, -1.4},
       {-3, 1.4},     {7, -1.4},      {4.667, 1.4},  {-2.333, -4.2},  {-2, 4.2},     {15, -1.4},
       {10.333, 1.4}, {-1.333, -1.4}});
  return model;
}

const Model& modelIn(std::string_view payload) {
  const auto id = littleEndian(payload, kTail + 5, 1);
  if (id == 0x22) return vlp16();
  if (id == 0x28) return vlp32c();
  throw DataError("Velodyne packet: byte 1205: model " + std::to_string(id) +
                  ", expected 34 (VLP-16) or 40 (VLP-32C)");
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

/// The manual's: lasers of a VLP-32C fire in pairs.
double timeInBlock(std::size_t j, bool two_firings) {
  return two_firings ? kFiring * static_cast<double>(j / 16) + kLaser * static_cast<double>(j % 16)
                     : kLaser * static_cast<double>(j / 2);
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
    packet.stamp_ns = static_cast<std::int64_t>(littleEndian(payload, kTail, 4)) * 1000;
    packet.turn = static_cast<float>(azimuths[0]) / kTurn;
    for (std::size_t b = 0; b < kBlocks; ++b) {
      const std::size_t from = b + echoes < kBlocks ? b : b - echoes;  // the last: the step before
      const int step = (azimuths[from + echoes] - azimuths[from] + kTurn) % kTurn;
      addBlock(payload, model, b, echoes, azimuths[b], step, packet);
    }
    return packet;
  }

 private:
  static void addBlock(std::string_view payload, const Model& model, std::size_t b,
                       std::size_t echoes, int azimuth, int step, DecodedPacket& packet) {
    const std::size_t lasers = model.beams.size(), echo = b % echoes;
    const bool two = lasers < kChannels;
    const double period = two ? 2 * kFiring : kFiring;
    for (std::size_t j = 0; j < kChannels; ++j) {
      const std::size_t at = b * kBlock + 4 + 3 * j;
      const auto raw = littleEndian(payload, at, 2);
      if (raw == 0 || (echo > 0 && payload.substr(at, 3) == payload.substr(at - kBlock, 3))) {
        continue;
      }
      const BeamAngles& beam = model.beams[j % lasers];
      const double after = timeInBlock(j, two);
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
