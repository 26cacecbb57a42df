#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/packets/ClockWatch.h"
#include "libperception/packets/Decoder.h"

namespace perception {

/// Turns one device's packets into its frames: a lidar's turn, a radar's list. A frame is stamped
/// with the reception of its first packet (the devices' clocks need not be set), its returns with
/// the time after that by the device's clock.
class FrameAssembler {
 public:
  using Take = std::function<void(SensorFrame&&)>;

  /// `file`: of calibration or metadata. Throws DataError, ConfigError for an unknown kind.
  FrameAssembler(const DeviceKind& kind, const std::string& file, std::string label,
                 const Pose3& T_ego_sensor, Take take);

  /// How packets come; default: the kind's.
  void setTransport(Transport transport) { transport_ = transport; }
  /// Added to the frames' stamps [s].
  void setTimeOffset(double seconds) { time_offset_ = seconds; }

  /// Adds one packet, received at `received`. A packet that cannot be decoded is counted, gives a
  /// warning, and is the only thing that is lost; a repeated packet is left out.
  void add(std::string_view payload, Stamp received);
  /// Gives the frame that has begun, which may be part of a turn.
  void finish();

  /// An event of the device or its connection, to be told among the warnings.
  void note(const std::string& what) { events_.add(sayWhere(what)); }

  const PacketLedger& ledger() const { return counter_.ledger(); }
  ClockLedger clock() const { return clock_.ledger(); }
  std::vector<std::string> lostRanges() const { return counter_.lostRanges(); }
  std::uint64_t frames() const { return frames_; }
  /// Damaged packets, then events (a device that started anew, a clock that was set); each with the
  /// number of its packet. The first 100 of either, and how many more there were.
  std::vector<std::string> warnings() const;

 private:
  /// The first texts of one kind, and the number of all.
  struct Notes {
    std::vector<std::string> texts;
    std::uint64_t count = 0;
    void add(std::string text);
  };

  void warn(const std::string& what) { faults_.add(sayWhere(what)); }
  std::string sayWhere(const std::string& what) const;
  void addBundle(std::string_view datagram, Stamp received);
  void addMessage(std::string_view message, Stamp received);
  bool isNew(const DecodedPacket& packet);
  void take(const DecodedPacket& packet, Stamp received);
  void addTurn(const DecodedPacket& packet, Stamp received);
  void addTargets(const DecodedPacket& packet, Stamp received);

  const DeviceKind& kind_;
  std::unique_ptr<PacketDecoder> decoder_;
  SequenceCounter counter_;  ///< of packets; of CAN frames in datagrams: of datagrams
  SequenceCounter scans_;    ///< of CAN frames in datagrams: what the frames count
  ClockWatch clock_;
  Transport transport_;
  double time_offset_ = 0;  ///< [s]
  SensorFrame frame_;       ///< the next one, without its data
  Take take_;
  LidarCloud cloud_;
  std::int64_t first_clock_ = 0;  ///< [ns] the device's at the frame's first packet
  float turn_ = 0;                ///< of the packet before
  bool begun_ = false;
  std::uint64_t frames_ = 0;
  Notes faults_, events_;
};

}  // namespace perception
