#include "libperception/capture/Grabber.h"

#include <fmt/format.h>
#include <mrpt/config/CConfigFile.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "libperception/capture/CPacketSensor.h"
#include "libperception/capture/CScenarioSensor.h"
#include "libperception/core/Error.h"
#include "libperception/core/MrptCompatibility.h"
#include "libperception/sensors/registerClasses.h"

namespace perception {
namespace {

using mrpt::hwdrivers::CGenericSensor;
constexpr auto kPollPeriod = std::chrono::milliseconds(10);

mrpt::config::CConfigFile openIni(const std::string& path) {
  if (!std::filesystem::is_regular_file(path))
    throw DataError(path + ": no such file", ExitCode::kNoInput);
  return mrpt::config::CConfigFile(path);
}

ChunkLimits limitsOf(const std::string& ini) {
  const auto config = openIni(ini);
  ChunkLimits limits;
  limits.seconds = config.read_double("global", "chunk_seconds", limits.seconds);
  limits.bytes = static_cast<std::uint64_t>(
      config.read_double("global", "chunk_mb", static_cast<double>(limits.bytes) * 1e-6) * 1e6);
  limits.free_bytes = static_cast<std::uint64_t>(
      config.read_double("global", "free_mb", static_cast<double>(limits.free_bytes) * 1e-6) * 1e6);
  if (!(limits.seconds > 0) || limits.bytes == 0)
    throw ConfigError(ini + ": [global] chunk_seconds and chunk_mb must be above 0");
  return limits;
}

CGenericSensor::Ptr startDriver(const mrpt::config::CConfigFile& config, const std::string& ini,
                                const std::string& section) {
  const std::string name = config.read_string(section, "driver", "");
  const auto driver = CGenericSensor::createSensorPtr(name);
  if (!driver)
    throw ConfigError(fmt::format("{}: [{}] driver {} is not known", ini, section, name));
  try {
    driver->loadConfig(config, section);
    driver->initialize();
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    throw ConfigError(fmt::format("{}: [{}] {}: {}", ini, section, name, error.what()));
  }
  return driver;
}

}  // namespace

Grabber::Grabber(const std::string& ini, const std::string& folder) : log_(folder, limitsOf(ini)) {
  registerPerceptionClasses();
  CScenarioSensor::doRegister();
  CPacketSensor::doRegister();
  const auto config = openIni(ini);
  std::vector<std::string> sections;
  config.getAllSections(sections);
  for (const std::string& section : sections) {
    if (!config.read_string(section, "driver", "").empty())
      drivers_.push_back(startDriver(config, ini, section));
  }
  if (drivers_.empty()) throw ConfigError(ini + ": no section with a driver");
  for (const auto& driver : drivers_) ledgers_[driver->getSensorLabel()];
}

void Grabber::poll() {
  CGenericSensor::TListObservations all;
  for (const auto& driver : drivers_) {
    driver->doProcess();
    for (auto& [stamp, object] : observationsOf(*driver)) {
      const auto observation = std::dynamic_pointer_cast<mrpt::obs::CObservation>(object);
      if (!observation) continue;
      SensorLedger& ledger = ledgers_[driver->getSensorLabel()];
      ++ledger.written;
      auto& last = last_[observation->sensorLabel];
      if (observation->timestamp < last) ++ledger.late;
      last = std::max(last, observation->timestamp);
      all.emplace(stamp, object);
    }
  }
  for (const auto& [stamp, object] : all)
    log_.write(dynamic_cast<const mrpt::obs::CObservation&>(*object));
}

void Grabber::run(const std::function<bool()>& done, const std::function<void()>& tick) {
  auto next_tick = std::chrono::steady_clock::now() + std::chrono::seconds(1);
  try {
    while (!done()) {
      poll();
      std::this_thread::sleep_for(kPollPeriod);
      if (std::chrono::steady_clock::now() < next_tick) continue;
      next_tick += std::chrono::seconds(1);
      log_.tend();
      tick();
    }
  } catch (const OutputError&) {
    endDrivers();
    noteLedgers();  // a line fits where no scan does
    throw;
  }
  endDrivers();
  poll();
  log_.close();
  noteLedgers();
}

void Grabber::endDrivers() {
  for (const auto& driver : drivers_) {
    if (auto* source = dynamic_cast<LedgerSource*>(driver.get())) source->endCapture();
  }
}

void Grabber::noteLedgers() {
  for (const auto& driver : drivers_) {
    const SensorLedger& ledger = ledgers_[driver->getSensorLabel()];
    nlohmann::json line{
        {"sensor", driver->getSensorLabel()}, {"written", ledger.written}, {"late", ledger.late}};
    if (const auto* source = dynamic_cast<const LedgerSource*>(driver.get())) {
      const PacketLedger p = source->packets();
      line["packets"] = {{"received", p.received}, {"damaged", p.damaged},
                         {"lost", p.lost},         {"repeated", p.repeated},
                         {"late", p.late},         {"lost_numbers", source->lostPackets()}};
      if (source->simulator()) {
        const SentLedger s = source->simulator()->ledger();
        line["simulator"] = {{"made", s.made},
                             {"dropped", s.dropped},
                             {"repeated", s.repeated},
                             {"swapped", s.swapped},
                             {"sent", s.sent}};
      }
    }
    log_.note(line.dump());
  }
}

std::vector<std::string> Grabber::warnings() const {
  std::vector<std::string> all;
  for (const auto& driver : drivers_) {
    const auto* source = dynamic_cast<const LedgerSource*>(driver.get());
    if (!source) continue;
    for (const std::string& warning : source->warnings()) all.push_back(warning);
    const PacketLedger p = source->packets();
    if (p.lost > 0)
      all.push_back(fmt::format("{}: {} of {} packets lost", driver->getSensorLabel(), p.lost,
                                p.lost + p.received - p.repeated));
  }
  return all;
}

}  // namespace perception
