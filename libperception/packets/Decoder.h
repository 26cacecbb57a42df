#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace perception {

/// One return of a lidar's packet, in the sensor's axes: x forward, y left, z up.
struct LidarReturn {
  float x = 0, y = 0, z = 0;   ///< [m]
  std::uint8_t intensity = 0;  ///< as sent
  std::uint16_t ring = 0;      ///< rank of the beam's elevation, 0 = lowest
  std::uint8_t echo = 0;       ///< order in the packet: 0, or 1 for the second of a dual return
  float time_us = 0;           ///< after the packet's stamp [us]
};

/// One detection of a radar, polar in the sensor's frame.
struct PacketTarget {
  float range = 0;       ///< [m]
  float azimuth = 0;     ///< [rad], left positive
  float elevation = 0;   ///< [rad], up positive; see has_elevation
  float range_rate = 0;  ///< [m/s], away positive
  float rcs = 0;         ///< [dBm2]
  bool has_elevation = false;
};

/// An object of a radar's own tracker, in the vehicle's frame.
struct RadarObject {
  std::uint32_t id = 0;
  float x = 0, y = 0, z = 0;    ///< reference point [m]
  float yaw = 0;                ///< [rad]
  float vx = 0, vy = 0;         ///< [m/s], relative to the vehicle where the radar tells it
  float length = 0, width = 0;  ///< [m]
};

/// What one packet tells, of whatever device.
struct DecodedPacket {
  std::int64_t stamp_ns = 0;  ///< the device's clock [ns]; of what epoch: see the decoder
  /// Number that rises by one from packet to packet, modulo `numbers`; empty: the device sends
  /// none.
  std::optional<std::uint64_t> number;
  std::uint64_t numbers = 0;
  float turn = 0;          ///< lidar: share of its turn, [0, 1), at the packet's beginning
  bool ends_scan = false;  ///< radar: its list of targets is whole with this packet
  std::vector<LidarReturn> returns;
  std::vector<PacketTarget> targets;
  std::vector<RadarObject> objects;
  std::vector<std::string> warnings;  ///< faults that cost nothing of this packet
};

/// Decoder of one device's packets; every size is checked before it is used.
class PacketDecoder {
 public:
  virtual ~PacketDecoder() = default;
  /// Throws DataError with the place in the packet; the next packet can be decoded all the same.
  virtual DecodedPacket decode(std::string_view payload) = 0;
};

/// A device whose packets are decoded.
struct DeviceKind {
  const char* name;
  const char* description;
  bool lidar;          ///< else a radar
  std::uint16_t port;  ///< usual UDP port; 0: CAN
  bool needs_file;     ///< of calibration or metadata; else such a file is optional or unused
  double max_range;    ///< [m], by the device's data sheet
  std::unique_ptr<PacketDecoder> (*make)(const std::string& file);
};
const std::vector<DeviceKind>& deviceKinds();
/// Throws ConfigError that lists the kinds there are.
const DeviceKind& deviceKind(const std::string& name);

/// The packets of one device, to the packet.
struct PacketLedger {
  std::uint64_t received = 0;  ///< all that came, damaged ones included
  std::uint64_t damaged = 0;   ///< refused by the decoder
  std::uint64_t lost = 0;      ///< missing by their number
  std::uint64_t repeated = 0;  ///< came again
  std::uint64_t late = 0;      ///< came after a later one; no longer counted as lost
};

/// Counts gaps by the packets' numbers, of the last 1024.
class SequenceCounter {
 public:
  /// Whether the packet is new; false for one that came before.
  bool count(const DecodedPacket& packet);
  void countDamaged() { ++ledger_.received, ++ledger_.damaged; }
  const PacketLedger& ledger() const { return ledger_; }
  /// Ranges of lost numbers as "12" or "12-15", at most 1000 of them.
  std::vector<std::string> lostRanges() const;

 private:
  PacketLedger ledger_;
  std::uint64_t numbers_ = 1;
  std::optional<std::uint64_t> last_;                          ///< unwrapped
  std::vector<std::pair<std::uint64_t, std::uint64_t>> gaps_;  ///< first and last lost number
};

}  // namespace perception
