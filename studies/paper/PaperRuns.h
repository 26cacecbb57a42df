#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "libperception/evaluation/front_ends/FrontEndEvaluation.h"
#include "libperception/evaluation/metrics/Evaluation.h"

namespace perception {

/// A weather of the tables of [radecki2016].
struct PaperWeather {
  const char* name;   ///< of its INI in ini/weather
  const char* title;  ///< as in [radecki2016]
  const char* table;  ///< of paperTrackingRows(); "": front ends only
};
/// Sunny, Night, Cloudy & Wet, Snow & Rain; last, of the cameras' recall and precision alone,
/// Rainy.
const std::vector<PaperWeather>& paperWeathers();

/// The sensor sets of the tables of [radecki2016].
inline constexpr const char* kPaperSets[] = {"L+R", "C+R", "C/H+R", "C+L+R"};
/// Numbers of particles of the runs in sun beside the INI's; their name is particlesName().
inline constexpr int kPaperParticles[] = {1, 4};
std::string particlesName(int particles);

/// What all encounters of the study have in common.
struct PaperSite {
  std::string ini = "ini";  ///< folder with scenarios/ and weather/
  std::string config;       ///< INI of the tracker; empty: INI/skynet.ini
  std::uint64_t seed = 1;   ///< of the first trials
  double seconds = 0;       ///< of each encounter; 0: all
  std::string vehicleConfig() const { return config.empty() ? ini + "/skynet.ini" : config; }
};

/// One simulated encounter: a trial of a scenario in a weather.
struct PaperEncounter {
  std::string scenario;  ///< A
  PaperWeather weather;
  int trial = 1;  ///< 1, 2, ...
};

/// What came of an encounter.
struct PaperOutcome {
  PaperEncounter of;
  std::map<std::string, Evaluation> runs;                ///< by sensor set or particlesName()
  std::map<std::string, FrontEndEvaluation> front_ends;  ///< by modality: Lidar, Camera, Radar
};

/// Simulates an encounter once for all sensor sets, and evaluates every one. Truth counts whatever
/// the number of lidar returns on it, so that the denominators do not depend on the weather.
PaperOutcome runPaperEncounter(const PaperSite& site, const PaperEncounter& encounter);

}  // namespace perception
