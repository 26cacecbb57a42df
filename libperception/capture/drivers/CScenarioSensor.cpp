#include "libperception/capture/drivers/CScenarioSensor.h"

#include <fmt/format.h>
#include <mrpt/config/CConfigFileBase.h>

#include <cstdio>

#include "libperception/core/Error.h"

namespace perception {

IMPLEMENTS_GENERIC_SENSOR(CScenarioSensor, perception)

// MRPT has read sensorLabel and process_rate before.
void CScenarioSensor::loadConfig_sensorSpecific(const mrpt::config::CConfigFileBase& config,
                                                const std::string& section) {
  source_.scenario = config.read_string(section, "scenario", "", true);
  source_.seed = config.read_uint64_t(section, "seed", source_.seed);
  source_.start_delay = config.read_double(section, "start_delay", source_.start_delay);
}

void CScenarioSensor::initialize() {
  player_ = ScenarioPlayer::shared(source_);
  if (!player_->has(m_sensorLabel)) {
    std::string known;
    for (const std::string& label : player_->labels()) known += " " + label;
    throw ConfigError(fmt::format("[{}] of the capture INI: {} has no such sensor; it has{}",
                                  m_sensorLabel, source_.scenario, known));
  }
  m_state = ssWorking;
}

void CScenarioSensor::doProcess() {
  for (const auto& observation : player_->take(m_sensorLabel)) appendObservation(observation);
  if (end_said_ || !player_->ended()) return;
  end_said_ = true;
  fmt::print("{}: {} is over, a key ends the recording\n", m_sensorLabel, source_.scenario);
  std::fflush(stdout);
}

}  // namespace perception
