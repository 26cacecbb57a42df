#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libperception/core/Error.h"
#include "libperception/packets/Bytes.h"
#include "libperception/packets/Decoders.h"

namespace perception {
namespace {

/// One of the two lists that the radar sends: a head with the number of its elements.
struct Ars408List {
  std::uint32_t head, element;
  std::size_t element_size;  ///< [bytes]
  std::size_t side_bits;     ///< of the lateral distance
  double side_least;         ///< [m]
};
constexpr Ars408List kArs408Clusters{0x600, 0x701, 8, 10, -102.3};
constexpr Ars408List kArs408Objects{0x60A, 0x60B, 8, 11, -204.6};
constexpr std::uint32_t kArs408Step = 16;  // from the identifiers of one sensor to the next
constexpr std::uint32_t kArs408Sensors = 8;
constexpr std::size_t kArs408Id = 4, kArs408Head = 4;

[[noreturn]] void refuseArs408(std::uint32_t id, const std::string& what) {
  throw DataError("ARS 408 message " + std::to_string(id) + ": " + what);
}

/// Bits from the highest of the first byte: number, distances, speeds, two spare bits, motion,
/// cross section.
PacketTarget ars408Target(std::string_view data, const Ars408List& list) {
  constexpr std::size_t kAhead = 8;  // first bit
  const std::size_t side = 32 - list.side_bits;
  const double x = .2 * bitsMsbFirst(data, kAhead, 13) - 500;
  const double y = .2 * bitsMsbFirst(data, side, list.side_bits) + list.side_least;
  const double vx = .25 * bitsMsbFirst(data, 32, 10) - 128;
  const double vy = .25 * bitsMsbFirst(data, 42, 9) - 64;
  PacketTarget target;
  const double range = std::hypot(x, y);
  target.range = static_cast<float>(range);
  target.azimuth = static_cast<float>(std::atan2(y, x));
  target.range_rate = static_cast<float>(range > 0 ? (vx * x + vy * y) / range : 0);
  target.rcs = static_cast<float>(.5 * bitsMsbFirst(data, 56, 8) - 64);
  target.id = static_cast<std::int32_t>(bitsMsbFirst(data, 0, 8));
  return target;
}

class Ars408Decoder final : public PacketDecoder {
 public:
  DecodedPacket decode(std::string_view message) override {
    const auto place = placeOf(message);
    if (!place) return {};  // others of the bus
    const auto& [list, id, sensor] = *place;
    if (!sensor_) sensor_ = sensor;
    if (*sensor_ != sensor) return {};
    const std::string_view data = message.substr(kArs408Id);
    if (id == list->head) return begin(*list, data);
    if (data.size() != list->element_size)
      refuseArs408(id, std::to_string(data.size()) + " bytes, expected 8");
    if (list_ != list) return {};  // began before we listened
    targets_.push_back(ars408Target(data, *list));
    return targets_.size() == expected_ ? end() : DecodedPacket{};
  }
  bool takes(std::string_view message) const override { return placeOf(message).has_value(); }

 private:
  struct Place {
    const Ars408List* list;
    std::uint32_t id, sensor;  ///< the identifier of sensor 0; the sensor
  };
  static std::optional<Place> placeOf(std::string_view message) {
    if (message.size() < kArs408Id) return {};
    const auto id = static_cast<std::uint32_t>(bigEndian(message, 0, kArs408Id));
    for (const Ars408List* list : {&kArs408Clusters, &kArs408Objects}) {
      for (const std::uint32_t first : {list->head, list->element}) {
        if (id >= first && (id - first) % kArs408Step == 0 &&
            (id - first) / kArs408Step < kArs408Sensors)
          return Place{list, first, (id - first) / kArs408Step};
      }
    }
    return {};
  }

  /// A list whose last element did not come is ended by the next head.
  DecodedPacket begin(const Ars408List& list, std::string_view data) {
    const bool clusters = &list == &kArs408Clusters;
    if (data.size() < kArs408Head)
      refuseArs408(list.head, std::to_string(data.size()) + " bytes, expected 4 or more");
    DecodedPacket before;
    if (list_ != nullptr) {
      before = end();
      before.warnings.push_back("ARS 408: list " + std::to_string(before.number.value_or(0)) +
                                ": fewer elements than announced");
    }
    list_ = &list;
    // Of clusters, those near and those far are counted apart.
    expected_ = bigEndian(data, 0, 1) + (clusters ? bigEndian(data, 1, 1) : 0);
    number_ = bigEndian(data, clusters ? 2 : 1, 2);
    if (expected_ > 0) return before;
    return before.ends_scan ? (list_ = nullptr, before) : end();
  }

  DecodedPacket end() {
    DecodedPacket packet;
    packet.ends_scan = true;
    packet.number = number_;
    packet.numbers = 65536;
    packet.identity = ++lists_;  // a bus does not repeat
    packet.targets = std::exchange(targets_, {});
    list_ = nullptr;
    return packet;
  }

  std::optional<std::uint32_t> sensor_;
  const Ars408List* list_ = nullptr;  ///< that has begun
  std::uint64_t expected_ = 0, number_ = 0, lists_ = 0;
  std::vector<PacketTarget> targets_;
};

}  // namespace

std::unique_ptr<PacketDecoder> makeArs408Decoder() { return std::make_unique<Ars408Decoder>(); }

}  // namespace perception
