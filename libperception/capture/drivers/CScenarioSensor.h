#pragma once
#include <mrpt/hwdrivers/CGenericSensor.h>

#include <memory>

#include "libperception/capture/drivers/ScenarioPlayer.h"

namespace perception {

/// One sensor of a simulated vehicle as a driver for MRPT's rawlog-grabber: outputs its
/// observations of a scenario in real time. Sensor: `sensorLabel`, as in the scenario's
/// [sensor.LABEL]; EGO_POSE is the vehicle itself (poses and frame numbers). Drivers with the same
/// scenario, seed and start_delay share one vehicle. Keys: ini/capture_stock.ini.
class CScenarioSensor : public mrpt::hwdrivers::CGenericSensor {
  DEFINE_GENERIC_SENSOR(CScenarioSensor)

 public:
  /// Throws if the scenario is invalid or has no sensor `sensorLabel` (the message lists its
  /// labels).
  void initialize() override;
  void doProcess() override;

 protected:
  void loadConfig_sensorSpecific(const mrpt::config::CConfigFileBase& config,
                                 const std::string& section) override;

 private:
  ScenarioSource source_;
  std::shared_ptr<ScenarioPlayer> player_;
  bool end_said_ = false;
};

}  // namespace perception
