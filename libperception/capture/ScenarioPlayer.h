#pragma once
#include <mrpt/obs/CObservation.h>

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <tuple>
#include <vector>

#include "libperception/simulation/Simulator.h"

namespace perception {

/// Which scenario is played, and when it begins.
struct ScenarioSource {
  std::string scenario;  ///< path of the scenario INI
  std::uint64_t seed = 1;
  double start_delay = 1;  ///< [s] from the first driver's start: the others join in that time

  bool operator<(const ScenarioSource& other) const {
    return std::tie(scenario, seed, start_delay) <
           std::tie(other.scenario, other.seed, other.start_delay);
  }
};

/// A simulated vehicle in real time. Every driver takes its own sensor's observations; nothing is
/// lost and nothing differs from what perception-simulate writes, but for the stamps, which are of
/// the time at which it was played. Drivers run in threads of their own: all calls are safe.
class ScenarioPlayer {
 public:
  using Observations = std::vector<std::shared_ptr<mrpt::obs::CObservation>>;

  /// Of the vehicle itself: poses, frame numbers and the comment that calls the log simulated.
  static constexpr const char* kVehicle = "EGO_POSE";

  /// Throws ConfigError with all faults of the scenario.
  explicit ScenarioPlayer(const ScenarioSource& source);

  /// The one player of a source that is shared by all who hold it.
  static std::shared_ptr<ScenarioPlayer> shared(const ScenarioSource& source);

  /// What that sensor has seen since it was asked last, in order of time; the clock starts with the
  /// first player's construction.
  Observations take(const std::string& label);
  /// The same at a time of the scenario [s].
  Observations takeUntil(const std::string& label, double t);

  bool has(const std::string& label) const;
  std::vector<std::string> labels() const;
  bool ended();  ///< and everything was taken

 private:
  void advanceTo(double t);

  std::mutex mutex_;
  std::map<std::string, Observations> waiting_;  ///< by label
  std::unique_ptr<Simulator> simulator_;
  std::shared_ptr<mrpt::obs::CObservation> next_;  ///< null at the end
  double first_ = 0;                             ///< [s] since 1970: stamp of the scenario's t = 0
  std::chrono::steady_clock::time_point start_;  ///< when t = 0 is played
  mrpt::Clock::duration shift_{0};               ///< from the scenario's stamps to those of today
};

}  // namespace perception
