#include <ctime>
#include <string>

#include "libperception/core/Error.h"
#include "libperception/packets/Bytes.h"
#include "libperception/packets/Decoders.h"
#include "libperception/packets/lidars/Beams.h"

namespace perception {
namespace {

/// How the two models' packets differ; offsets [bytes].
struct Layout {
  const char* name;
  std::size_t size, sequence;  ///< of the packet; of its number, at the end
  bool always_numbered;
  std::size_t first_block, block, blocks, channels, channel;
  std::size_t block_header;  ///< before the azimuth
  std::size_t mode, calendar, micros;
  int year;  ///< of the calendar's 0
};

constexpr std::int64_t kLastSecond = 9000000000;  // that fits in nanoseconds
constexpr Layout kPandar40p{"Pandar40P", 1262, 1262, false, 0,    124,  10,
                            40,          3,    2,    1254,  1256, 1250, 2000};
constexpr Layout kXt32{"XT32", 1080, 1076, true, 12, 130, 8, 32, 4, 0, 1062, 1065, 1071, 1900};

class HesaiDecoder final : public PacketDecoder {
 public:
  HesaiDecoder(const Layout& layout, std::vector<BeamAngles> beams)
      : at_(layout), beams_(std::move(beams)), rings_(ringsOf(beams_)) {}

  DecodedPacket decode(std::string_view payload) override {
    const double unit = check(payload);
    DecodedPacket packet;
    packet.stamp_ns = stampOf(payload);
    if (payload.size() >= at_.sequence + 4) {
      packet.number = littleEndian(payload, at_.sequence, 4);
      packet.numbers = std::uint64_t{1} << 32;
    }
    packet.turn =
        static_cast<float>(littleEndian(payload, at_.first_block + at_.block_header, 2)) / 36000.F;
    const auto mode = littleEndian(payload, at_.mode, 1);
    const std::size_t echoes = mode == 0x39 || (mode >= 0x3A && mode <= 0x3C) ? 2 : 1;
    for (std::size_t b = 0; b < at_.blocks; ++b) addBlock(payload, b, echoes, unit, packet);
    return packet;
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw DataError(std::string(at_.name) + " packet: " + what);
  }

  /// The unit of distances [m].
  double check(std::string_view payload) const {
    const bool numbered = !at_.always_numbered && payload.size() == at_.size + 4;
    if (payload.size() != at_.size && !numbered)
      refuse(std::to_string(payload.size()) + " bytes, expected " + std::to_string(at_.size));
    for (std::size_t b = 0; b < at_.blocks; ++b) {
      const std::size_t at = at_.first_block + b * at_.block;
      if (at_.block_header == 2 && littleEndian(payload, at, 2) != 0xEEFF)
        refuse("byte " + std::to_string(at) + ": block flag FF EE expected");
      const auto azimuth = littleEndian(payload, at + at_.block_header, 2);
      if (azimuth >= 36000)
        refuse("block " + std::to_string(b) + ": azimuth " + std::to_string(azimuth) +
               ", expected below 36000");
    }
    if (at_.first_block == 0) return 0.004;
    if (bigEndian(payload, 0, 3) != 0xEEFF06) refuse("byte 0: header EE FF 06 expected");
    if (littleEndian(payload, 6, 1) != at_.channels || littleEndian(payload, 7, 1) != at_.blocks)
      refuse("byte 6: lasers and blocks are not 32 and 8");
    if (littleEndian(payload, 9, 1) == 0) refuse("byte 9: unit of distances is 0");
    return 0.001 * static_cast<double>(littleEndian(payload, 9, 1));
  }

  std::int64_t stampOf(std::string_view payload) const {
    const auto field = [&](std::size_t i) {
      return static_cast<int>(littleEndian(payload, at_.calendar + i, 1));
    };
    std::tm calendar{};
    calendar.tm_year = field(0) + at_.year - 1900;
    calendar.tm_mon = field(1) - 1;
    calendar.tm_mday = field(2);
    calendar.tm_hour = field(3);
    calendar.tm_min = field(4);
    calendar.tm_sec = field(5);
    const std::int64_t seconds = timegm(&calendar);
    if (seconds > kLastSecond) refuse("its date lies centuries ahead");
    return seconds * 1000000000 +
           static_cast<std::int64_t>(littleEndian(payload, at_.micros, 4)) * 1000;
  }

  /// [us] after the packet's stamp; the manuals' firing times, of the Pandar40P without those of
  /// single channels (at most 54.7 us earlier).
  double timeOf(std::size_t b, std::size_t channel, std::size_t echoes) const {
    const auto blocks = static_cast<double>((at_.blocks - 1 - b) / echoes);
    if (at_.channels == 40) return -28.58 - 55.56 * blocks;
    return 5.632 - 50 * blocks + .368 + 1.512 * static_cast<double>(channel);
  }

  void addBlock(std::string_view payload, std::size_t b, std::size_t echoes, double unit,
                DecodedPacket& packet) const {
    const std::size_t block = at_.first_block + b * at_.block + at_.block_header;
    const double azimuth = static_cast<double>(littleEndian(payload, block, 2)) / 100;
    const std::size_t echo = b % echoes;
    for (std::size_t c = 0; c < at_.channels; ++c) {
      const std::size_t at = block + 2 + at_.channel * c;
      const auto raw = littleEndian(payload, at, 2);
      if (raw == 0) continue;
      if (echo > 0 && payload.substr(at, 3) == payload.substr(at - at_.block, 3)) continue;
      LidarReturn point = returnAt(static_cast<double>(raw) * unit, azimuth + beams_[c].azimuth,
                                   beams_[c].elevation);
      point.intensity = static_cast<std::uint8_t>(payload[at + 2]);
      point.ring = rings_[c];
      point.echo = static_cast<std::uint8_t>(echo);
      point.time_us = static_cast<float>(timeOf(b, c, echoes));
      packet.returns.push_back(point);
    }
  }

  const Layout& at_;
  std::vector<BeamAngles> beams_;
  std::vector<std::uint16_t> rings_;
};

}  // namespace

std::unique_ptr<PacketDecoder> makePandar40pDecoder(const std::string& file) {
  return std::make_unique<HesaiDecoder>(kPandar40p,
                                        file.empty() ? pandar40pBeams() : readBeams(file, 40));
}

std::unique_ptr<PacketDecoder> makeXt32Decoder(const std::string& file) {
  return std::make_unique<HesaiDecoder>(kXt32, file.empty() ? xt32Beams() : readBeams(file, 32));
}

}  // namespace perception
