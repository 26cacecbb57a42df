#include "libperception/packets/lidars/Ouster.h"

#include <array>
#include <cmath>

#include "libperception/core/Error.h"
#include "libperception/packets/Bytes.h"
#include "libperception/packets/Decoders.h"
#include "libperception/packets/lidars/Beams.h"

namespace perception {
namespace {

/// Sizes of a profile's packet [bytes].
struct Profile {
  const char* name;
  std::size_t pixel, packet_header, column_header, column_status, footer;
};
constexpr std::uint64_t kLastStamp = std::uint64_t{1} << 62;  // [ns] the year 2116

constexpr std::array<Profile, 4> kProfiles{{{"LEGACY", 12, 0, 16, 4, 0},
                                            {"RNG19_RFL8_SIG16_NIR16", 12, 32, 12, 0, 32},
                                            {"RNG19_RFL8_SIG16_NIR16_DUAL", 16, 32, 12, 0, 32},
                                            {"RNG15_RFL8_NIR8", 4, 32, 12, 0, 32}}};

[[noreturn]] void refuseOuster(const std::string& what) {
  throw DataError("Ouster packet: " + what);
}

const Profile& profileOf(const std::string& name) {
  for (const Profile& profile : kProfiles) {
    if (name == profile.name) return profile;
  }
  throw DataError("Ouster: udp_profile_lidar: unknown profile " + name);
}

/// CRC-64 of the packet without its last eight bytes (reflected polynomial).
std::uint64_t crc64(std::string_view bytes) {
  static const auto kTable = [] {
    std::array<std::uint64_t, 256> table{};
    for (std::uint64_t i = 0; i < table.size(); ++i) {
      std::uint64_t value = i;
      for (int k = 0; k < 8; ++k)
        value = (value & 1) ? (value >> 1) ^ 0xC96C5795D7870F42ULL : value >> 1;
      table[i] = value;
    }
    return table;
  }();
  std::uint64_t crc = ~std::uint64_t{0};
  for (const char byte : bytes)
    crc = kTable[(crc ^ static_cast<std::uint8_t>(byte)) & 0xFF] ^ (crc >> 8);
  return ~crc;
}

OusterPixel pixelAt(std::string_view bytes, std::size_t at, const Profile& profile) {
  const auto u16 = [&](std::size_t o) {
    return static_cast<std::uint16_t>(littleEndian(bytes, at + o, 2));
  };
  const auto u8 = [&](std::size_t o) { return static_cast<std::uint8_t>(bytes[at + o]); };
  const auto word = static_cast<std::uint32_t>(littleEndian(bytes, at, 4));
  OusterPixel pixel;
  if (profile.pixel == 4) {
    pixel.range[0] = (word & 0x7FFF) * 8;
    pixel.reflectivity[0] = u8(2);
    pixel.near_infrared = static_cast<std::uint16_t>(u8(3) * 16);
  } else if (profile.pixel == 12) {
    pixel.range[0] = word & (profile.packet_header == 0 ? 0xFFFFFU : 0x7FFFFU);
    pixel.reflectivity[0] = u8(4);
    pixel.signal[0] = u16(6);
    pixel.near_infrared = u16(8);
  } else {
    pixel.range[0] = word & 0x7FFFF;
    pixel.reflectivity[0] = u8(3);
    pixel.range[1] = static_cast<std::uint32_t>(littleEndian(bytes, at + 4, 4)) & 0x7FFFF;
    pixel.reflectivity[1] = u8(7);
    pixel.signal[0] = u16(8);
    pixel.signal[1] = u16(10);
    pixel.near_infrared = u16(12);
  }
  return pixel;
}

class OusterDecoder final : public PacketDecoder {
 public:
  explicit OusterDecoder(OusterMetadata metadata) : metadata_(std::move(metadata)) {
    std::vector<BeamAngles> beams;
    for (std::size_t i = 0; i < metadata_.altitudes.size(); ++i)
      beams.push_back({metadata_.altitudes[i], metadata_.azimuths[i]});
    rings_ = ringsOf(beams);
    profileOf(metadata_.profile);
  }

  DecodedPacket decode(std::string_view payload) override {
    DecodedPacket packet;
    const auto columns = ousterColumns(payload, metadata_, packet.warnings);
    const OusterColumn& first = columns.front();
    if (first.stamp_ns > kLastStamp) refuseOuster("its stamp lies centuries ahead");
    packet.stamp_ns = static_cast<std::int64_t>(first.stamp_ns);
    const std::size_t in_frame = metadata_.columns_per_frame / metadata_.columns_per_packet;
    packet.number = first.frame * in_frame + first.measurement / metadata_.columns_per_packet;
    packet.numbers = 65536 * in_frame;
    packet.turn =
        static_cast<float>(first.measurement) / static_cast<float>(metadata_.columns_per_frame);
    for (const OusterColumn& column : columns) {
      if (column.valid) addColumn(column, first.stamp_ns, packet);
    }
    return packet;
  }

 private:
  // The sensor's axes: the lidar's turned by half a turn (x and y negated).
  void addColumn(const OusterColumn& column, std::uint64_t start, DecodedPacket& packet) const {
    const double encoder = 2 * M_PI *
                           (1 - static_cast<double>(column.measurement) /
                                    static_cast<double>(metadata_.columns_per_frame));
    const double n = metadata_.origin_to_beam;
    for (std::size_t i = 0; i < column.pixels.size(); ++i) {
      const double angle = encoder - metadata_.azimuths[i] * M_PI / 180;
      const double up = metadata_.altitudes[i] * M_PI / 180;
      for (std::size_t echo = 0; echo < 2; ++echo) {
        if (column.pixels[i].range[echo] == 0) continue;
        const double r = 0.001 * column.pixels[i].range[echo];
        LidarReturn point;
        point.x =
            static_cast<float>(-((r - n) * std::cos(angle) * std::cos(up) + n * std::cos(encoder)));
        point.y =
            static_cast<float>(-((r - n) * std::sin(angle) * std::cos(up) + n * std::sin(encoder)));
        point.z = static_cast<float>((r - n) * std::sin(up) + kUp);
        point.intensity = column.pixels[i].reflectivity[echo];
        point.ring = rings_[i];
        point.echo = static_cast<std::uint8_t>(echo);
        // A clock that is set between two columns would give any number.
        const auto after = static_cast<std::int64_t>(column.stamp_ns - start);
        point.time_us = after < 0 || after > 1000000000 ? 0 : static_cast<float>(after) * 1e-3F;
        packet.returns.push_back(point);
      }
    }
  }

  static constexpr double kUp = 0.03618;  ///< [m] of the lidar above the sensor's origin
  OusterMetadata metadata_;
  std::vector<std::uint16_t> rings_;
};

}  // namespace

std::vector<OusterColumn> ousterColumns(std::string_view payload, const OusterMetadata& metadata,
                                        std::vector<std::string>& warnings) {
  const Profile& profile = profileOf(metadata.profile);
  const std::size_t rows = metadata.altitudes.size();
  const std::size_t column_size =
      profile.column_header + rows * profile.pixel + profile.column_status;
  const std::size_t size =
      profile.packet_header + metadata.columns_per_packet * column_size + profile.footer;
  if (payload.size() != size)
    refuseOuster(std::to_string(payload.size()) + " bytes, expected " + std::to_string(size) +
                 " (" + profile.name + ", " + std::to_string(rows) + " rows)");
  const bool legacy = profile.packet_header == 0;
  if (!legacy && littleEndian(payload, 0, 2) != 1) refuseOuster("byte 0: type 1 (lidar) expected");
  if (!legacy) {
    const auto sent = littleEndian(payload, size - 8, 8);
    if (sent != 0 && sent != crc64(payload.substr(0, size - 8)))
      warnings.emplace_back("Ouster packet: checksum is wrong");
  }
  std::vector<OusterColumn> columns(metadata.columns_per_packet);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const std::size_t at = profile.packet_header + c * column_size;
    OusterColumn& column = columns[c];
    column.stamp_ns = littleEndian(payload, at, 8);
    column.measurement = static_cast<std::uint16_t>(littleEndian(payload, at + 8, 2));
    column.frame = static_cast<std::uint16_t>(littleEndian(payload, legacy ? at + 10 : 2, 2));
    if (column.measurement >= metadata.columns_per_frame)
      refuseOuster("column " + std::to_string(c) + ": measurement " +
                   std::to_string(column.measurement) + ", expected below " +
                   std::to_string(metadata.columns_per_frame));
    column.valid = legacy ? littleEndian(payload, at + column_size - 4, 4) == 0xFFFFFFFF
                          : (littleEndian(payload, at + 10, 2) & 1) == 1;
    for (std::size_t i = 0; i < rows; ++i)
      column.pixels.push_back(
          pixelAt(payload, at + profile.column_header + i * profile.pixel, profile));
  }
  return columns;
}

std::unique_ptr<PacketDecoder> makeOusterDecoder(const std::string& file) {
  try {
    return std::make_unique<OusterDecoder>(readOusterMetadata(file));
  } catch (const DataError& error) {
    if (std::string(error.what()).rfind(file, 0) == 0) throw;
    throw DataError(file + ": " + error.what());
  }
}

}  // namespace perception
