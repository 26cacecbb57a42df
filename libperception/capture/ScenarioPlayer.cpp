#include "libperception/capture/ScenarioPlayer.h"

#include <filesystem>
#include <utility>

#include "libperception/config/Config.h"
#include "libperception/sensors/Conversions.h"
#include "libperception/simulation/Scenario.h"

namespace perception {
namespace {

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
  next_ = simulator_->next();
  const auto delay = std::chrono::duration_cast<std::chrono::nanoseconds>(
      std::chrono::duration<double>(source.start_delay));
  start_ = std::chrono::steady_clock::now() + delay;
  shift_ = mrpt::Clock::now() - fromStamp(Stamp::fromSeconds(first_)) +
           std::chrono::duration_cast<mrpt::Clock::duration>(delay);
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

void ScenarioPlayer::advanceTo(double t) {
  while (next_ && mrpt::Clock::toDouble(next_->timestamp) - first_ <= t) {
    const auto queue = waiting_.find(next_->sensorLabel);
    next_->timestamp += shift_;
    // Comments have no sensor label: they are assigned to the vehicle.
    (queue != waiting_.end() ? queue->second : waiting_[kVehicle]).push_back(std::move(next_));
    next_ = simulator_->next();
  }
}

ScenarioPlayer::Observations ScenarioPlayer::takeUntil(const std::string& label, double t) {
  const std::lock_guard<std::mutex> lock(mutex_);
  advanceTo(t);
  const auto queue = waiting_.find(label);
  return queue == waiting_.end() ? Observations() : std::exchange(queue->second, {});
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
  return !next_;
}

}  // namespace perception
