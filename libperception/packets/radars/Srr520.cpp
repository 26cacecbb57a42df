#include "libperception/packets/radars/Srr520.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "libperception/core/Error.h"
#include "libperception/packets/Bytes.h"
#include "libperception/packets/Decoders.h"

namespace perception {
namespace {

[[noreturn]] void refuseSrr520(const std::string& what) {
  throw DataError("SRR520 message: " + what);
}

/// One of the three lists that the radar sends: a header, elements, and 800 that closes it.
struct List {
  const char* name;
  std::uint32_t header;  ///< CAN id; elements: the next one
  std::size_t elements, in_element;
};
constexpr std::array<List, 3> kLists{
    {{"near", 900, 50, 10}, {"far", 1100, 20, 10}, {"objects", 1200, 20, 2}}};
constexpr std::size_t kHeaderSize = 32, kElementSize = 64, kCloseSize = 4, kCanIdSize = 4;

/// Reads fields one after the other, the most significant bit first.
class BitReader {
 public:
  BitReader(std::string_view bytes, std::size_t first) : bytes_(bytes), bit_(first) {}
  double next(std::size_t count, double scale = 1, double offset = 0) {
    const double value = bitsMsbFirst(bytes_, bit_, count) * scale + offset;
    bit_ += count;
    return value;
  }
  void skip(std::size_t count) { bit_ += count; }

 private:
  std::string_view bytes_;
  std::size_t bit_;
};

PacketTarget targetAt(std::string_view bytes, std::size_t bit) {
  BitReader reader(bytes, bit);
  PacketTarget target;
  target.range = static_cast<float>(reader.next(12, .024420024));
  target.azimuth = static_cast<float>(reader.next(9, .006159986, -M_PI / 2));
  target.range_rate = static_cast<float>(reader.next(11, .014662757, -15));
  target.rcs = static_cast<float>(reader.next(7, .476190476, -40));
  return target;
}

RadarObject srr520ObjectAt(std::string_view bytes, std::size_t bit) {
  BitReader reader(bytes, bit);
  RadarObject object;
  object.id = static_cast<std::uint32_t>(reader.next(8));
  object.x = static_cast<float>(reader.next(16, .009155553, -300));
  object.y = static_cast<float>(reader.next(16, .009155553, -300));
  object.vx = static_cast<float>(reader.next(14, .009156391, -75));
  object.vy = static_cast<float>(reader.next(14, .009156391, -75));
  reader.skip(2 * 10 + 6 * 14);  // accelerations, standard deviations
  object.length = static_cast<float>(reader.next(12, .007326007));
  object.width = static_cast<float>(reader.next(12, .007326007));
  object.yaw = static_cast<float>(reader.next(12, .001534729, -3.14159));
  return object;
}

class Srr520Decoder final : public PacketDecoder {
 public:
  DecodedPacket decode(std::string_view message) override {
    if (message.size() < kCanIdSize)
      refuseSrr520(std::to_string(message.size()) + " bytes, no CAN identifier");
    const auto id = static_cast<std::uint32_t>(bigEndian(message, 0, kCanIdSize));
    const std::string_view data = message.substr(kCanIdSize);
    for (std::size_t i = 0; i < kLists.size(); ++i) {
      if (id == kLists[i].header) begin(i, data);
      if (id == kLists[i].header + 1) addElement(i, data);
    }
    return id == 800 ? close(data) : DecodedPacket{};
  }
  bool takes(std::string_view message) const override {
    if (message.size() < kCanIdSize) return false;
    const std::uint64_t id = bigEndian(message, 0, kCanIdSize);
    return id == 800 || std::any_of(kLists.begin(), kLists.end(), [&](const List& list) {
             return id == list.header || id == list.header + 1;
           });
  }

 private:
  static void expectSize(std::string_view data, std::size_t size, std::uint32_t id) {
    if (data.size() != size)
      refuseSrr520(std::to_string(id) + ": " + std::to_string(data.size()) + " bytes, expected " +
                   std::to_string(size));
  }

  void begin(std::size_t i, std::string_view data) {
    group_[i].clear();
    expectSize(data, kHeaderSize, kLists[i].header);
    group_[i] = data;
  }

  void addElement(std::size_t i, std::string_view data) {
    expectSize(data, kElementSize, kLists[i].header + 1);
    const std::size_t have = group_[i].size();
    if (have == 0) refuseSrr520(std::string(kLists[i].name) + ": element without header");
    if (have >= kHeaderSize + kLists[i].elements * kElementSize)
      refuseSrr520(std::string(kLists[i].name) + ": too many elements");
    if (littleEndian(data, 63, 1) != littleEndian(group_[i], 14, 1))
      refuseSrr520(std::string(kLists[i].name) + ": element of another list");
    group_[i] += data;
  }

  DecodedPacket close(std::string_view data) {
    expectSize(data, kCloseSize, 800);
    const auto i = littleEndian(data, 0, 1);
    if (i >= kLists.size()) refuseSrr520("800: list " + std::to_string(i) + ", expected 0 to 2");
    const std::string group = std::move(group_[i]);
    group_[i].clear();
    if (group.empty()) refuseSrr520(std::string(kLists[i].name) + ": closed without header");
    if (srr520Checksum(group) != bigEndian(data, 1, 2))
      refuseSrr520(std::string(kLists[i].name) + ": checksum is wrong, the list is left out");
    return decodeList(kLists[i], group);
  }

  static DecodedPacket decodeList(const List& list, std::string_view group) {
    const bool objects = list.in_element == 2;
    const auto count = objects ? bigEndian(group, 24, 1) : bigEndian(group, 23, 2);
    const std::size_t room = (group.size() - kHeaderSize) / kElementSize * list.in_element;
    if (count > room)
      refuseSrr520(std::string(list.name) + ": " + std::to_string(count) + " entries, room for " +
                   std::to_string(room));
    DecodedPacket packet;
    packet.stamp_ns = static_cast<std::int64_t>(bigEndian(group, 4, 4)) * 1000000000 +
                      static_cast<std::int64_t>(bigEndian(group, 8, 4));
    packet.ends_scan = !objects;
    const auto sync = bigEndian(group, 12, 1);
    packet.clock = sync == 1   ? ClockState::kSynchronized
                   : sync == 3 ? ClockState::kLost
                               : ClockState::kNeverSet;
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t element = kHeaderSize + k / list.in_element * kElementSize;
      const std::size_t bits = (objects ? 248 : 48) * (k % list.in_element);
      if (objects) {
        packet.objects.push_back(srr520ObjectAt(group, element * 8 + bits));
      } else {
        packet.targets.push_back(targetAt(group, element * 8 + bits));
      }
    }
    return packet;
  }

  std::array<std::string, 3> group_;  ///< header and elements so far
};

}  // namespace

std::uint16_t srr520Checksum(std::string_view bytes) {
  std::uint32_t crc = 0xFFFF;
  for (const char byte : bytes) {
    crc ^= static_cast<std::uint32_t>(static_cast<std::uint8_t>(byte)) << 8;
    for (int i = 0; i < 8; ++i) crc = (crc & 0x8000) ? (crc << 1) ^ 0x1021 : crc << 1;
    crc &= 0xFFFF;
  }
  return static_cast<std::uint16_t>(crc);
}

std::unique_ptr<PacketDecoder> makeSrr520Decoder() { return std::make_unique<Srr520Decoder>(); }

}  // namespace perception
