#include <algorithm>
#include <cmath>

#include "libperception/core/Error.h"
#include "libperception/packets/Bytes.h"
#include "libperception/packets/Encoder.h"
#include "libperception/packets/lidars/BeamView.h"
#include "libperception/packets/lidars/Ouster.h"

namespace perception {
namespace {

constexpr std::size_t kLegacyHeader = 16, kPixel = 12, kLegacyStatus = 4;  ///< of profile LEGACY

/// Packets of profile LEGACY. The lidar's center and the beams' origin lie apart (kUp, n): returns
/// are seen from the beams' origin.
class OusterEncoder final : public PacketEncoder {
 public:
  explicit OusterEncoder(const std::string& file) : metadata_(readOusterMetadata(file)) {
    if (metadata_.profile != "LEGACY")
      throw DataError(file + ": udp_profile_lidar " + metadata_.profile +
                      ": a simulated Ouster sends LEGACY only");
    for (std::size_t i = 0; i < metadata_.altitudes.size(); ++i)
      beams_.push_back({metadata_.altitudes[i], metadata_.azimuths[i]});
  }

  std::vector<TimedPacket> encode(const SensorFrame& frame, double period) override {
    const BeamView view(fromBeams(cloudOf(frame)), beams_);
    const std::size_t columns = metadata_.columns_per_frame, in = metadata_.columns_per_packet;
    const std::size_t size = kLegacyHeader + beams_.size() * kPixel + kLegacyStatus;
    std::vector<TimedPacket> packets;
    for (std::size_t first = 0; first < columns; first += in) {
      std::string bytes(in * size, '\0');
      for (std::size_t c = 0; c < in; ++c) {
        const double share = static_cast<double>(first + c) / static_cast<double>(columns);
        const std::size_t at = c * size;
        putLittle(bytes, at,
                  static_cast<std::uint64_t>(frame.stamp.ns) +
                      static_cast<std::uint64_t>(share * period * 1e9),
                  8);
        putLittle(bytes, at + 8, first + c, 2);
        putLittle(bytes, at + 10, number_, 2);
        putLittle(bytes, at + 12, static_cast<std::uint64_t>(share * 90112), 4);
        putPixels(bytes, at + kLegacyHeader, view, share);
        putLittle(bytes, at + size - kLegacyStatus, 0xFFFFFFFF, 4);
      }
      packets.push_back(
          {period * static_cast<double>(first + in) / static_cast<double>(columns), bytes});
    }
    ++number_;
    return packets;
  }

  void restart() override { number_ = 0; }

 private:
  /// From the sensor's axes to those of the view: x and y negated (half a turn), from the beams'
  /// origin, which goes around the lidar's axis at a distance n. With that direction unknown for a
  /// cell, the return's own is taken: off by n sin(azimuth offset), a millimeter.
  LidarCloud fromBeams(const LidarCloud& cloud) const {
    LidarCloud out = cloud;
    const auto n = static_cast<float>(metadata_.origin_to_beam);
    for (std::size_t i = 0; i < out.size(); ++i) {
      const float flat = std::hypot(out.x[i], out.y[i]);
      const float scale = flat > n ? -(flat - n) / flat : 0;
      out.x[i] *= scale;
      out.y[i] *= scale;
      out.z[i] -= kUp;
    }
    return out;
  }

  void putPixels(std::string& bytes, std::size_t at, const BeamView& view, double share) const {
    const double step = 360 / static_cast<double>(metadata_.columns_per_frame);
    for (std::size_t i = 0; i < beams_.size(); ++i) {
      const auto seen = view.at(i, 360 * share + beams_[i].azimuth, step);
      if (!seen) continue;
      const double mm = std::round(1000 * (seen->range + metadata_.origin_to_beam));
      if (mm > 0xFFFFF) continue;
      const std::size_t pixel = at + i * kPixel;
      putLittle(bytes, pixel, static_cast<std::uint64_t>(mm), 4);
      bytes[pixel + 4] =
          static_cast<char>(std::lround(std::clamp(seen->intensity, 0.F, 1.F) * 255));
    }
  }

  static constexpr float kUp = 0.03618F;  ///< [m] of the lidar above the sensor's origin
  OusterMetadata metadata_;
  std::vector<BeamAngles> beams_;
  std::uint16_t number_ = 0;
};

}  // namespace

std::unique_ptr<PacketEncoder> makeOusterEncoder(const std::string& file) {
  return std::make_unique<OusterEncoder>(file);
}

}  // namespace perception
