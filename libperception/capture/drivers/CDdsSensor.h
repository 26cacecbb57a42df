#pragma once
#include <mrpt/hwdrivers/CGenericSensor.h>

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "libperception/capture/LedgerSource.h"
#include "libperception/dds/ObservationTopic.h"

namespace perception {

/// Observations that perception-grabber --publish of other processes or computers sends by DDS, as
/// a driver. Keys: README.md of this folder.
class CDdsSensor : public mrpt::hwdrivers::CGenericSensor, public LedgerSource {
  DEFINE_GENERIC_SENSOR(CDdsSensor)

 public:
  /// Throws Error (kUnavailable).
  void initialize() override;
  void doProcess() override;

  void endCapture() override {}
  PacketLedger packets() const override;
  std::vector<std::string> lostPackets() const override { return {}; }
  std::vector<std::string> warnings() const override;
  const DeviceSimulator* simulator() const override { return nullptr; }

 protected:
  void loadConfig_sensorSpecific(const mrpt::config::CConfigFileBase& config,
                                 const std::string& section) override;

 private:
  NetworkName network_;
  mutable std::mutex mutex_;  ///< of subscriber_
  std::unique_ptr<ObservationSubscriber> subscriber_;
};

}  // namespace perception
