#include "libperception/capture/drivers/CRawlogSensor.h"

#include <fmt/format.h>
#include <mrpt/config/CConfigFileBase.h>

#include <cstdio>
#include <sstream>
#include <utility>
#include <vector>

#include "libperception/core/Error.h"
#include "libperception/sensors/observations/Conversions.h"
#include "libperception/sensors/rawlog/RawlogReader.h"

namespace perception {

IMPLEMENTS_GENERIC_SENSOR(CRawlogSensor, perception)

namespace {

constexpr double kAhead = 0.5;  ///< [s] read before it is due
constexpr double kMissed =
    0.05;  ///< [s] overdue: was before this device came up, which does not send it
constexpr double kPause = 0.1;  ///< [s] between two times through the log

double secondsNow() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

}  // namespace

// MRPT has read sensorLabel and process_rate before.
void CRawlogSensor::loadConfig_sensorSpecific(const mrpt::config::CConfigFileBase& config,
                                              const std::string& section) {
  log_ = config.read_string(section, "rawlog", "", true);
  std::istringstream labels(config.read_string(section, "labels", ""));
  for (std::string label; labels >> label;) labels_.insert(label);
  speed_ = config.read_double(section, "speed", speed_);
  start_at_ = config.read_double(section, "start_at", start_at_);
  repeats_ = config.read_uint64_t(section, "repeats", repeats_);
  if (!(speed_ > 0)) throw ConfigError(fmt::format("[{}] speed must be above 0", section));
}

void CRawlogSensor::initialize() {
  RawlogReader{log_};  // says what is wrong with it, here and not in the thread
  joins_ = start_at_ > 0;
  if (!joins_) start_at_ = secondsNow();
  thread_ = std::thread([this] { read(); });
  m_state = ssWorking;
}

CRawlogSensor::~CRawlogSensor() {
  stop_ = true;
  taken_.notify_all();
  if (thread_.joinable()) thread_.join();
}

bool CRawlogSensor::wants(const mrpt::obs::CObservation& observation) const {
  return labels_.empty() || labels_.count(observation.sensorLabel) > 0;
}

bool CRawlogSensor::put(double due, std::shared_ptr<mrpt::obs::CObservation> observation) {
  std::unique_lock<std::mutex> lock(mutex_);
  waiting_.push_back({due, std::move(observation)});
  while (!stop_ && waiting_.back().due > secondsNow() + kAhead)
    taken_.wait_for(lock, std::chrono::milliseconds(20));
  return !stop_;
}

void CRawlogSensor::read() {
  double begin = 0;  // [s] of this time through the log after the start of the first
  bool joined = !joins_;
  try {
    for (std::uint64_t i = 0; (repeats_ == 0 || i < repeats_) && !stop_; ++i) {
      RawlogReader reader(log_);
      std::optional<Stamp> first;
      double length = 0;
      while (const auto observation = reader.next()) {
        const auto stamp = toStamp(observation->timestamp);
        if (stamp && !first) first = stamp;
        if (stamp) length = *stamp - *first;
        if (!wants(*observation)) continue;
        // Moved by a multiple of 100 ns, in which MRPT counts: intervals stay what they are.
        if (stamp) {
          const Stamp start = Stamp::fromSeconds(start_at_ + begin);
          const std::int64_t move = (start.ns - first->ns) / 100 * 100;
          observation->timestamp = fromStamp({stamp->ns + move});
        }
        const double due = start_at_ + (begin + length) / speed_;
        joined = joined || secondsNow() - due < kMissed;
        if (!joined) continue;
        if (!put(due, observation)) return;
      }
      begin += length + kPause;
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", log_, error.what());
  }
  read_all_ = true;
}

void CRawlogSensor::doProcess() {
  const double now = secondsNow();
  std::vector<std::shared_ptr<mrpt::obs::CObservation>> due;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    while (!waiting_.empty() && waiting_.front().due <= now) {
      due.push_back(std::move(waiting_.front().observation));
      waiting_.pop_front();
    }
    ended_ = read_all_ && waiting_.empty();
  }
  taken_.notify_all();
  for (const auto& observation : due) appendObservation(observation);
}

}  // namespace perception
