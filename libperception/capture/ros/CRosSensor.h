#pragma once
#include <mrpt/hwdrivers/CGenericSensor.h>

#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "libperception/capture/LedgerSource.h"
#include "libperception/capture/ros/RosIntake.h"
#include "libperception/dds/RosGraph.h"

namespace perception {

/// The topics of a running ROS 2 graph as a driver, by DDS and without ROS: by the INI of
/// perception-import bag. Keys: README.md of this folder.
class CRosSensor : public mrpt::hwdrivers::CGenericSensor, public LedgerSource {
  DEFINE_GENERIC_SENSOR(CRosSensor)

 public:
  ~CRosSensor() override;
  /// Throws Error (kUnavailable).
  void initialize() override;
  void doProcess() override;

  void endCapture() override;
  PacketLedger packets() const override;
  std::vector<std::string> lostPackets() const override { return {}; }
  std::vector<std::string> warnings() const override;
  std::vector<std::string> notes() const override;
  const DeviceSimulator* simulator() const override { return nullptr; }

 protected:
  /// Throws ConfigError, also for the INI.
  void loadConfig_sensorSpecific(const mrpt::config::CConfigFileBase& config,
                                 const std::string& section) override;

 private:
  /// A topic that is read, or that was.
  struct Source {
    std::string type;
    std::unique_ptr<RawReader> reader;  ///< none while no process writes the topic
    RawReader::Ledger before;           ///< of earlier readers
    RawReader::Ledger ledger() const;
  };

  void lookAround();
  void open(const std::string& topic, const GraphTopic& found);
  void close(Source& source);
  void receive();
  RawReader::Ledger ledgerOfAll() const;

  std::string ini_;
  std::unique_ptr<RosIntake> intake_;
  std::shared_ptr<Network> network_;
  std::unique_ptr<RosGraph> graph_;
  int waitset_ = 0;
  std::chrono::steady_clock::time_point next_look_;
  std::map<std::string, GraphTopic> known_;
  std::map<std::string, Source> sources_;  ///< by topic
};

}  // namespace perception
