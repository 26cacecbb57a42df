#include "libperception/capture/drivers/CDdsSensor.h"

#include <fmt/format.h>
#include <mrpt/config/CConfigFileBase.h>

namespace perception {

IMPLEMENTS_GENERIC_SENSOR(CDdsSensor, perception)

// MRPT has read sensorLabel and process_rate before.
void CDdsSensor::loadConfig_sensorSpecific(const mrpt::config::CConfigFileBase& config,
                                           const std::string& section) {
  network_ = NetworkName::parse(config.read_string(section, "network", "lo"));
}

void CDdsSensor::initialize() {
  subscriber_ = std::make_unique<ObservationSubscriber>(network_);
  m_state = ssWorking;
}

void CDdsSensor::doProcess() {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const auto& observation : subscriber_->take()) appendObservation(observation);
}

PacketLedger CDdsSensor::packets() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto& ledger = subscriber_->ledger();
  PacketLedger packets;
  packets.received = ledger.received;
  packets.lost = ledger.lost;
  packets.damaged = ledger.damaged;
  return packets;
}

std::vector<std::string> CDdsSensor::warnings() const {
  const auto damaged = packets().damaged;
  if (damaged == 0) return {};
  return {fmt::format("{}: {} messages are no observations that this program knows", m_sensorLabel,
                      damaged)};
}

}  // namespace perception
