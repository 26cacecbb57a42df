#pragma once
#include <mrpt/hwdrivers/CGenericSensor.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "libperception/capture/LedgerSource.h"
#include "libperception/capture/simulated/DeviceSimulator.h"
#include "libperception/capture/sources/PacketSource.h"
#include "libperception/capture/sources/SenderGuard.h"
#include "libperception/packets/FrameAssembler.h"

namespace perception {

/// A lidar or radar that sends packets (packets/Decoder.h) by UDP, TCP or CAN, as a driver for
/// perception-grabber and MRPT's rawlog-grabber; with `replay` or `scenario`, it starts a simulator
/// of its device on this computer. Keys: README.md of this folder.
class CPacketSensor : public mrpt::hwdrivers::CGenericSensor, public LedgerSource {
  DEFINE_GENERIC_SENSOR(CPacketSensor)

 public:
  ~CPacketSensor() override;
  /// Throws ConfigError, DataError, Error (kUnavailable) if the port or the interface cannot be
  /// opened.
  void initialize() override;
  void doProcess() override;

  void endCapture() override;
  PacketLedger packets() const override;
  std::vector<std::string> lostPackets() const override;
  std::vector<std::string> warnings() const override;
  std::uint64_t refused() const override;
  std::uint64_t overrun() const override;
  ClockLedger clock() const override;
  const DeviceSimulator* simulator() const override { return simulator_.get(); }

 protected:
  void loadConfig_sensorSpecific(const mrpt::config::CConfigFileBase& config,
                                 const std::string& section) override;

 private:
  struct Keys {
    std::string device, device_file, host, multicast, interface;
    Transport transport = Transport::kUdp;
    std::uint16_t port = 0;
    double time_offset = 0;  ///< [s]
    std::string replay;
    std::uint16_t replay_port = 0;
    double replay_speed = 1;
    DeviceSource source;
    PacketFaults faults;
    bool simulated() const { return !replay.empty() || !source.scenario.scenario.empty(); }
  };

  static void readSimulator(const mrpt::config::CConfigFileBase& config, const std::string& section,
                            Keys& keys);
  std::unique_ptr<PacketSource> openSource() const;
  void startSimulator();
  void receive();
  void take(const ReceivedPacket& packet);

  Keys keys_;
  std::unique_ptr<DeviceSimulator> simulator_;
  mutable std::mutex mutex_;  ///< of what follows, up to frames_
  std::unique_ptr<PacketSource> source_;
  std::unique_ptr<FrameAssembler> assembler_;
  SenderGuard senders_;
  std::uint64_t overrun_ = 0;
  std::vector<SensorFrame> frames_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace perception
