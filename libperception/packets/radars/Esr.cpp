#include <array>
#include <bitset>
#include <cmath>
#include <optional>
#include <string>

#include "libperception/core/Error.h"
#include "libperception/packets/Bytes.h"
#include "libperception/packets/Decoders.h"

namespace perception {
namespace {

constexpr std::uint32_t kTracks = 0x500, kPower = 0x540, kStatus = 0x4E0;
constexpr std::size_t kCount = 64, kGroups = 10, kInGroup = 7, kCanId = 4, kData = 8;

/// Track states with a measurement in this scan: new, new updated, updated, merged; not: none,
/// coasted, invalid coasted, new coasted.
constexpr bool isMeasured(std::uint32_t state) {
  return state == 1 || state == 2 || state == 3 || state == 5;
}

[[noreturn]] void refuse(std::uint32_t id, const std::string& what) {
  throw DataError("ESR message " + std::to_string(id) + ": " + what);
}

/// The state of a track's message; `target` where it is measured.
std::optional<PacketTarget> targetIn(std::string_view data, std::size_t track) {
  if (!isMeasured(bitsMsbFirst(data, 8, 3))) return std::nullopt;
  PacketTarget target;
  target.range = static_cast<float>(.1 * bitsMsbFirst(data, 21, 11));
  // Clockwise angles.
  target.azimuth = static_cast<float>(-.1 * signedBitsMsbFirst(data, 11, 10) * M_PI / 180);
  target.range_rate = static_cast<float>(.01 * signedBitsMsbFirst(data, 50, 14));
  target.id = static_cast<std::int32_t>(track + 1);
  return target;
}

class EsrDecoder final : public PacketDecoder {
 public:
  DecodedPacket decode(std::string_view message) override {
    if (message.size() < kCanId)
      refuse(0, std::to_string(message.size()) + " bytes, no identifier");
    const auto id = static_cast<std::uint32_t>(bigEndian(message, 0, kCanId));
    if (!takes(message)) return {};  // others of the bus
    const std::string_view data = message.substr(kCanId);
    if (data.size() != kData) refuse(id, std::to_string(data.size()) + " bytes, expected 8");
    if (id == kStatus) return begin(static_cast<std::uint16_t>(bigEndian(data, 3, 2)));
    if (id == kPower) return addPowers(data);
    seen_.set(id - kTracks);
    targets_[id - kTracks] = targetIn(data, id - kTracks);
    return {};
  }

  bool takes(std::string_view message) const override {
    if (message.size() < kCanId) return false;
    const std::uint64_t id = bigEndian(message, 0, kCanId);
    return (id >= kTracks && id <= kPower) || id == kStatus;
  }

 private:
  /// A scan that its last group of powers did not end is ended by the next one's index.
  DecodedPacket begin(std::uint16_t index) {
    DecodedPacket before;
    if (index_ && *index_ != index && seen_.any()) before = end();
    index_ = index;
    return before;
  }

  DecodedPacket addPowers(std::string_view data) {
    const std::size_t group = bitsMsbFirst(data, 4, 4);
    if (group >= kGroups) refuse(kPower, "group " + std::to_string(group) + ", expected 0 to 9");
    for (std::size_t i = 0; i < kInGroup; ++i) {
      const std::size_t track = group * kInGroup + i;
      if (track < kCount)
        powers_[track] = static_cast<float>(bitsMsbFirst(data, 8 * (1 + i) + 3, 5)) - 10;
    }
    return group + 1 == kGroups ? end() : DecodedPacket{};
  }

  /// The scan as it is. One without an index began before we listened: it is left out.
  DecodedPacket end() {
    DecodedPacket packet;
    if (index_ && seen_.any()) {
      packet.ends_scan = true;
      packet.number = *index_;
      packet.numbers = 65536;
      packet.identity = ++scans_;  // a bus does not repeat
      for (std::size_t i = 0; i < kCount; ++i) {
        if (!targets_[i]) continue;
        targets_[i]->rcs = powers_[i];
        packet.targets.push_back(*targets_[i]);
      }
      if (!seen_.all())
        packet.warnings.push_back("ESR: scan " + std::to_string(*index_) + ": " +
                                  std::to_string(kCount - seen_.count()) +
                                  " of 64 track messages are missing");
    }
    seen_.reset();
    targets_ = {};
    powers_ = {};
    return packet;
  }

  std::optional<std::uint16_t> index_;
  std::bitset<kCount> seen_;
  std::array<std::optional<PacketTarget>, kCount> targets_;
  std::array<float, kCount> powers_{};
  std::uint64_t scans_ = 0;
};

}  // namespace

std::unique_ptr<PacketDecoder> makeEsrDecoder() { return std::make_unique<EsrDecoder>(); }

}  // namespace perception
