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
  float pulse_width = 0;       ///< [m]; see DecodedPacket::labeled
  std::uint8_t label = 0;      ///< PointLabel; see DecodedPacket::labeled
};

/// What a packet says about the device's clock.
enum class ClockState : std::uint8_t { kUntold, kNeverSet, kSynchronized, kLost };
const char* nameOf(ClockState state);

/// One detection of a radar, polar in the sensor's frame.
struct PacketTarget {
  float range = 0;       ///< [m]
  float azimuth = 0;     ///< [rad], left positive
  float elevation = 0;   ///< [rad], up positive; see has_elevation
  float range_rate = 0;  ///< [m/s], away positive
  float rcs = 0;         ///< [dBm2]; of the ESR: power [dB]
  std::int32_t id = -1;  ///< of the radar's own track; -1: none
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

/// The content of one packet, in a form that is common to all devices.
struct DecodedPacket {
  std::int64_t stamp_ns = 0;         ///< the device's clock [ns]; each decoder states its epoch
  std::int64_t clock_period_ns = 0;  ///< after which the clock begins anew; 0: never
  ClockState clock = ClockState::kUntold;
  /// Number that rises by one from packet to packet, modulo `numbers`; empty: the device sends
  /// none.
  std::optional<std::uint64_t> number;
  std::uint64_t numbers = 0;
  /// Differs between two packets that have the same number but are not the same; 0: the stamp does.
  std::uint64_t identity = 0;
  float turn = 0;  ///< lidar: share of its turn, [0, 1), at the packet's beginning
  bool ends_scan =
      false;             ///< radar: its list of targets is whole with this packet; lidar: its scan
  bool labeled = false;  ///< its returns have pulse widths and labels
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
  /// Whether it is the device's own, where its packets come among others (CAN).
  virtual bool takes(std::string_view) const { return true; }
};

class PacketEncoder;

/// How packets come: datagrams of their own, messages one after the other in a TCP stream (of
/// Ibeo), frames of a CAN bus, or several of such frames in a datagram (CanBundle.h).
enum class Transport : std::uint8_t { kUdp, kTcp, kCan, kCanUdp };

/// A device whose packets are decoded.
struct DeviceKind {
  const char* name;
  const char* description;
  bool lidar;  ///< else a radar
  Transport transport;
  std::uint16_t port;  ///< usual UDP or TCP port; of CAN: 0
  bool needs_file;     ///< of calibration or metadata; else such a file is optional or unused
  double max_range;    ///< [m], by the device's data sheet
  std::unique_ptr<PacketDecoder> (*make)(const std::string& file);
  std::unique_ptr<PacketEncoder> (*makeEncoder)(const std::string& file);  ///< for simulated ones
  std::uint16_t second_port = 0;  ///< of what the device says of itself; 0: none is needed
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
  std::uint64_t restarts = 0;  ///< times that the numbers began anew: the device was switched on
};

/// Counts gaps by the packets' numbers, of the last 1024. Numbers that go back farther, or that
/// came before with another stamp, are those of a device that was started anew.
class SequenceCounter {
 public:
  /// Whether the packet is new; false for one that came before.
  bool count(const DecodedPacket& packet);
  void countDamaged() { ++ledger_.received, ++ledger_.damaged; }
  const PacketLedger& ledger() const { return ledger_; }
  /// Ranges of lost numbers as "12" or "12-15", the first 1000 of them. Numbers that run to 255
  /// only are counted on from turn to turn.
  std::vector<std::string> lostRanges() const;

 private:
  bool isAnotherOf(std::uint64_t number, const DecodedPacket& packet) const;
  void beginAt(const DecodedPacket& packet);
  bool countEarlier(std::uint64_t number, const DecodedPacket& packet);
  void addGap(std::uint64_t from, std::uint64_t to);
  void remember(std::uint64_t number, const DecodedPacket& packet);

  PacketLedger ledger_;
  std::uint64_t numbers_ = 1;
  std::optional<std::uint64_t> last_;                          ///< unwrapped
  std::vector<std::pair<std::uint64_t, std::uint64_t>> gaps_;  ///< first and last lost number
  std::vector<std::pair<std::uint64_t, std::uint64_t>> seen_;  ///< number and identity, by its rest
};

}  // namespace perception
