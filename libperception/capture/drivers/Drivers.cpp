#include "libperception/capture/drivers/Drivers.h"

#include <fmt/format.h>
#include <mrpt/config/CConfigFile.h>
#include <mrpt/config/CConfigFileMemory.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <filesystem>
#include <mutex>
#include <thread>
#include <utility>

#include "libperception/capture/LedgerSource.h"
#include "libperception/capture/drivers/registerDrivers.h"
#include "libperception/core/Error.h"
#include "libperception/core/MrptCompatibility.h"
#include "libperception/sensors/observations/registerClasses.h"

namespace perception {
namespace {

using mrpt::hwdrivers::CGenericSensor;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

/// Between two looks at a driver: its process_rate, within these.
constexpr double kShortestPeriod = 0.001, kLongestPeriod = 0.02;  // [s]
constexpr auto kPatience = std::chrono::seconds(2);  ///< with a driver that does not return

CGenericSensor::Ptr startDriver(const mrpt::config::CConfigFileBase& config, const std::string& ini,
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

std::optional<std::string> rosIniOf(const std::string& name) {
  constexpr char kRos[] = "ros2:";
  if (name.rfind(kRos, 0) != 0) return std::nullopt;
  return name.substr(sizeof kRos - 1);
}

std::shared_ptr<const mrpt::config::CConfigFileBase> openCaptureIni(const std::string& name) {
  const auto ros = rosIniOf(name);
  const std::string& file = ros ? *ros : name;
  if (!(ros && file.empty()) && !std::filesystem::is_regular_file(file))
    throw DataError(file + ": no such file", ExitCode::kNoInput);
  if (!ros) return std::make_shared<mrpt::config::CConfigFile>(name);
  auto config = std::make_shared<mrpt::config::CConfigFileMemory>();
  config->write("ROS2", "driver", std::string("CRosSensor"));
  config->write("ROS2", "sensorLabel", std::string("ROS2"));
  config->write("ROS2", "ini", file);
  return config;
}

struct Drivers::Shared {
  enum class State { kWorking, kEnded, kFailed };

  std::atomic<bool> stop{false};
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<Arrival> arrived;
  std::vector<State> states;         ///< by driver
  std::vector<std::string> faults;   ///< by driver
  std::vector<std::thread> threads;  ///< by driver
  std::vector<bool> over;            ///< by driver: its thread was joined
};

Drivers::Drivers(const std::string& ini) : shared_(std::make_shared<Shared>()) {
  registerPerceptionClasses();
  registerDrivers();
  const auto opened = openCaptureIni(ini);
  const mrpt::config::CConfigFileBase& config = *opened;
  std::vector<std::string> sections;
  config.getAllSections(sections);
  for (const std::string& section : sections) {
    if (!config.read_string(section, "driver", "").empty())
      drivers_.push_back(startDriver(config, ini, section));
  }
  if (drivers_.empty()) throw ConfigError(ini + ": no section with a driver");
  shared_->states.assign(size(), Shared::State::kWorking);
  shared_->faults.resize(size());
  shared_->over.assign(size(), false);
  for (std::size_t i = 0; i < size(); ++i)
    shared_->threads.emplace_back(
        [driver = drivers_[i], i, shared = shared_] { ask(driver, i, shared); });
}

Drivers::~Drivers() { end(); }

void Drivers::ask(const CGenericSensor::Ptr& driver, std::size_t index,
                  const std::shared_ptr<Shared>& shared) {
  const double rate = driver->getProcessRate();
  const auto period =
      std::chrono::duration_cast<steady_clock::duration>(std::chrono::duration<double>(
          std::clamp(rate > 0 ? 1 / rate : 0, kShortestPeriod, kLongestPeriod)));
  const auto look = [&] {
    driver->doProcess();
    const auto observations = observationsOf(*driver);
    if (observations.empty()) return;
    const auto now = steady_clock::now();
    const std::lock_guard<std::mutex> lock(shared->mutex);
    for (const auto& [stamp, object] : observations) {
      if (auto observation = std::dynamic_pointer_cast<mrpt::obs::CObservation>(object))
        shared->arrived.push_back({std::move(observation), index, now});
    }
    shared->changed.notify_all();
  };
  std::string fault;
  try {
    while (!shared->stop) {
      look();
      std::this_thread::sleep_for(period);
    }
    if (auto* source = dynamic_cast<LedgerSource*>(driver.get())) source->endCapture();
    look();
  } catch (const std::exception& error) {
    fault = fmt::format("{}: its driver failed: {}", driver->getSensorLabel(), error.what());
  }
  const std::lock_guard<std::mutex> lock(shared->mutex);
  shared->states[index] = fault.empty() ? Shared::State::kEnded : Shared::State::kFailed;
  shared->faults[index] = fault;
  shared->changed.notify_all();
}

std::vector<Drivers::Arrival> Drivers::take(milliseconds wait) {
  std::unique_lock<std::mutex> lock(shared_->mutex);
  shared_->changed.wait_for(lock, wait, [&] { return !shared_->arrived.empty(); });
  return std::exchange(shared_->arrived, {});
}

void Drivers::end() {
  if (std::exchange(ended_, true)) return;
  shared_->stop = true;
  const auto isOver = [](Shared::State s) {
    return s == Shared::State::kEnded || s == Shared::State::kFailed;
  };
  std::unique_lock<std::mutex> lock(shared_->mutex);
  shared_->changed.wait_for(lock, kPatience, [&] {
    return std::all_of(shared_->states.begin(), shared_->states.end(), isOver);
  });
  for (std::size_t i = 0; i < size(); ++i) {
    const bool over = isOver(shared_->states[i]);
    if (!over) shared_->faults[i] = label(i) + ": its driver does not return";
    lock.unlock();
    over ? shared_->threads[i].join() : shared_->threads[i].detach();
    lock.lock();
    shared_->over[i] = over;
  }
}

bool Drivers::isOver(std::size_t i) const {
  const std::lock_guard<std::mutex> lock(shared_->mutex);
  return shared_->over[i];
}

std::vector<std::string> Drivers::faults() const {
  std::vector<std::string> out;
  const std::lock_guard<std::mutex> lock(shared_->mutex);
  for (const std::string& fault : shared_->faults)
    if (!fault.empty()) out.push_back(fault);
  return out;
}

}  // namespace perception
