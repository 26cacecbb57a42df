#pragma once
#include <atomic>
#include <chrono>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libperception/capture/drivers/ScenarioPlayer.h"
#include "libperception/core/Frames.h"
#include "libperception/packets/Decoder.h"
#include "libperception/packets/Encoder.h"

namespace perception {

/// A packet and when it is to be sent.
struct DuePacket {
  std::chrono::steady_clock::time_point due;
  std::string payload;
};

/// What a simulated device sends.
class PacketFeed {
 public:
  virtual ~PacketFeed() = default;
  /// The next one; waits for it until `stop`. Empty: no more.
  virtual std::optional<DuePacket> next(const std::atomic<bool>& stop) = 0;
};

/// Packets of a capture to a port, with its pauses divided by `speed` (0: without pauses).
class RecordedFeed final : public PacketFeed {
 public:
  /// Throws DataError: no pcap, no packet to the port.
  RecordedFeed(const std::string& pcap, std::uint16_t port, double speed);
  std::optional<DuePacket> next(const std::atomic<bool>& stop) override;

 private:
  struct Packet {
    double after = 0;  ///< [s] the first one
    std::string payload;
  };
  std::vector<Packet> packets_;
  double speed_;
  std::size_t at_ = 0;
  std::chrono::steady_clock::time_point begin_;
};

/// A device of a simulated vehicle.
struct DeviceSource {
  ScenarioSource scenario;
  std::string sensor;                      ///< of the scenario, whose scans are sent
  std::string device_file;                 ///< as the decoder's
  bool bundled = false;                    ///< CAN frames in datagrams
  Pose3 T_ego_sensor = Pose3::Identity();  ///< of the device
  double clock_step = 0,
         clock_step_after = 0;  ///< [s] how much the device's clock is set, and when
  double restart_after = 0;     ///< [s] when its numbers begin anew; 0: never
};

/// Packets made of the scans of a simulated vehicle's sensor.
class ScenarioFeed final : public PacketFeed {
 public:
  /// Throws ConfigError, DataError.
  ScenarioFeed(const DeviceKind& kind, const DeviceSource& source);
  std::optional<DuePacket> next(const std::atomic<bool>& stop) override;

 private:
  void encode(const mrpt::obs::CObservation& observation);
  void place(SensorFrame& frame) const;
  std::vector<TimedPacket> bundled(std::vector<TimedPacket> messages);

  DeviceSource source_;
  std::shared_ptr<ScenarioPlayer> player_;
  std::unique_ptr<PacketEncoder> encoder_;
  std::deque<DuePacket> waiting_;
  std::optional<Stamp> first_, last_;
  double period_ = 0.1;  ///< [s]
  bool restarted_ = false;
  std::uint8_t bundles_ = 0;
};

}  // namespace perception
