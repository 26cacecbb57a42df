#pragma once
#include <mrpt/hwdrivers/CGenericSensor.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "libperception/capture/LedgerSource.h"
#include "libperception/capture/PacketReplay.h"
#include "libperception/packets/FrameAssembler.h"

namespace perception {

/// A lidar or radar that sends UDP packets (packets/Decoder.h) as a driver for perception-grabber
/// and MRPT's rawlog-grabber; with `replay`, it starts a simulator of its device on loopback. Keys:
/// README.md of this folder.
class CPacketSensor : public mrpt::hwdrivers::CGenericSensor, public LedgerSource {
  DEFINE_GENERIC_SENSOR(CPacketSensor)

 public:
  ~CPacketSensor() override;
  /// Throws ConfigError, DataError, Error (kUnavailable) if the port is taken.
  void initialize() override;
  void doProcess() override;

  void endCapture() override;
  PacketLedger packets() const override;
  std::vector<std::string> lostPackets() const override;
  std::vector<std::string> warnings() const override;
  const PacketReplay* simulator() const override { return replay_.get(); }

 protected:
  void loadConfig_sensorSpecific(const mrpt::config::CConfigFileBase& config,
                                 const std::string& section) override;

 private:
  void receive();

  std::string device_, file_, bind_ = "0.0.0.0";
  std::uint16_t port_ = 0;
  Pose3 T_ego_sensor_ = Pose3::Identity();
  ReplayParams replay_params_;
  std::unique_ptr<PacketReplay> replay_;
  mutable std::mutex mutex_;  ///< of assembler_ and frames_
  std::unique_ptr<FrameAssembler> assembler_;
  std::vector<SensorFrame> frames_;
  int socket_ = -1;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace perception
