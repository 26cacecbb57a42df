#pragma once
#include <mrpt/obs/CObservation.h>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "libperception/simulation/Simulator.h"

namespace perception {

/// Scenario, seed and start of a simulated vehicle.
struct ScenarioSource {
  std::string scenario;  ///< path of the scenario INI
  std::uint64_t seed = 1;
  double start_delay = 1;  ///< [s] from the start of the first driver, so that the others can join

  bool operator<(const ScenarioSource& other) const {
    return std::tie(scenario, seed, start_delay) <
           std::tie(other.scenario, other.seed, other.start_delay);
  }
};

/// A simulated vehicle in real time. Each driver takes its sensor's observations. They equal those
/// of perception-simulate except for the stamps, which are of the time of playback. Simulates half
/// a second ahead in a thread of its own, so that no sensor waits for another. Thread-safe.
class ScenarioPlayer {
 public:
  using Observations = std::vector<std::shared_ptr<mrpt::obs::CObservation>>;

  /// Label of ego poses, frame numbers and the comment that marks the log as simulated.
  static constexpr const char* kVehicle = "EGO_POSE";

  /// Throws ConfigError with all faults of the scenario.
  explicit ScenarioPlayer(const ScenarioSource& source);
  ~ScenarioPlayer();
  ScenarioPlayer(const ScenarioPlayer&) = delete;
  ScenarioPlayer& operator=(const ScenarioPlayer&) = delete;

  /// The player of a source, shared while anyone holds it.
  static std::shared_ptr<ScenarioPlayer> shared(const ScenarioSource& source);

  /// Observations of a sensor since the last call, in chronological order; the clock starts with
  /// the construction.
  Observations take(const std::string& label);
  /// The same up to scenario time t [s].
  Observations takeUntil(const std::string& label, double t);

  bool has(const std::string& label) const;
  std::vector<std::string> labels() const;
  bool ended();  ///< true when the scenario is over and all observations were taken

 private:
  void simulate();

  struct Waiting {
    double t = 0;  ///< [s] of the scenario
    std::shared_ptr<mrpt::obs::CObservation> observation;
  };

  std::mutex mutex_;  ///< of what follows, but not of the simulator
  std::condition_variable changed_;
  std::map<std::string, std::deque<Waiting>> waiting_;  ///< by label
  double wanted_ = 0, simulated_ = 0;                   ///< [s] of the scenario
  bool over_ = false, stop_ = false;
  std::exception_ptr failure_;  ///< of the simulator

  std::unique_ptr<Simulator> simulator_;
  double first_ = 0;                             ///< [s] since 1970: stamp of the scenario's t = 0
  std::chrono::steady_clock::time_point start_;  ///< when t = 0 is played
  mrpt::Clock::duration shift_{0};               ///< offset from scenario stamps to playback stamps
  std::thread thread_;
};

}  // namespace perception
