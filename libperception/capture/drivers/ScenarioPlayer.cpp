#include "libperception/capture/drivers/ScenarioPlayer.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "libperception/config/Config.h"
#include "libperception/sensors/observations/Conversions.h"
#include "libperception/simulation/world/Scenario.h"

namespace perception {
namespace {

constexpr double kSimulatedAhead = 0.5;  ///< [s] simulated before it is due

Scenario scenarioOf(const std::string& path) {
  Config config = Config::fromFile(path);
  Scenario scenario = readScenario(config);
  config.finish();
  return scenario;
}

}  // namespace

ScenarioPlayer::ScenarioPlayer(const ScenarioSource& source) {
  Scenario scenario = scenarioOf(source.scenario);
  for (const SensorParams& sensor : scenario.sensors) waiting_[sensor.label];
  waiting_[kVehicle];
  first_ = scenario.params.start_utc;
  simulator_ = std::make_unique<Simulator>(
      std::move(scenario), std::filesystem::path(source.scenario).stem().string(), source.seed);
  const auto delay = std::chrono::duration_cast<std::chrono::nanoseconds>(
      std::chrono::duration<double>(source.start_delay));
  start_ = std::chrono::steady_clock::now() + delay;
  shift_ = mrpt::Clock::now() - fromStamp(Stamp::fromSeconds(first_)) +
           std::chrono::duration_cast<mrpt::Clock::duration>(delay);
  thread_ = std::thread([this] { simulate(); });
}

ScenarioPlayer::~ScenarioPlayer() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

std::shared_ptr<ScenarioPlayer> ScenarioPlayer::shared(const ScenarioSource& source) {
  static std::mutex mutex;
  static std::map<ScenarioSource, std::weak_ptr<ScenarioPlayer>> players;
  const std::lock_guard<std::mutex> lock(mutex);
  auto player = players[source].lock();
  if (!player) {
    player = std::make_shared<ScenarioPlayer>(source);
    players[source] = player;
  }
  return player;
}

void ScenarioPlayer::simulate() {
  for (;;) {
    std::shared_ptr<mrpt::obs::CObservation> observation;
    std::exception_ptr failure;
    try {
      observation = simulator_->next();
    } catch (...) {
      failure = std::current_exception();
    }
    std::unique_lock<std::mutex> lock(mutex_);
    failure_ = failure;
    if (!observation) {
      over_ = true;
      changed_.notify_all();
      return;
    }
    const double t = mrpt::Clock::toDouble(observation->timestamp) - first_;
    observation->timestamp += shift_;
    // Comments have no sensor label: they are assigned to the vehicle.
    const auto queue = waiting_.find(observation->sensorLabel);
    (queue != waiting_.end() ? queue->second : waiting_[kVehicle])
        .push_back({t, std::move(observation)});
    simulated_ = t;
    changed_.notify_all();
    changed_.wait(lock, [&] { return stop_ || simulated_ <= wanted_ + kSimulatedAhead; });
    if (stop_) return;
  }
}

ScenarioPlayer::Observations ScenarioPlayer::takeUntil(const std::string& label, double t) {
  std::unique_lock<std::mutex> lock(mutex_);
  wanted_ = std::max(wanted_, t);
  changed_.notify_all();
  changed_.wait(lock, [&] { return over_ || stop_ || simulated_ > t; });
  if (failure_) std::rethrow_exception(failure_);
  Observations out;
  const auto queue = waiting_.find(label);
  if (queue == waiting_.end()) return out;
  while (!queue->second.empty() && queue->second.front().t <= t) {
    out.push_back(std::move(queue->second.front().observation));
    queue->second.pop_front();
  }
  return out;
}

ScenarioPlayer::Observations ScenarioPlayer::take(const std::string& label) {
  const std::chrono::duration<double> t = std::chrono::steady_clock::now() - start_;
  return takeUntil(label, t.count());
}

bool ScenarioPlayer::has(const std::string& label) const { return waiting_.count(label) > 0; }

std::vector<std::string> ScenarioPlayer::labels() const {
  std::vector<std::string> labels;
  for (const auto& [label, queue] : waiting_) labels.push_back(label);
  return labels;
}

bool ScenarioPlayer::ended() {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const auto& [label, queue] : waiting_) {
    if (!queue.empty()) return false;
  }
  return over_;
}

}  // namespace perception
