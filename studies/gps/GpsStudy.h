#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libperception/evaluation/tables/StudyReport.h"
#include "studies/gps/SpeedRegimes.h"
#include "studies/paper/PaperFilters.h"

namespace perception {

/// Classification of travel modes from positions at 1 Hz (the GPS experiment of [radecki2016]).
struct GpsParams {
  std::string folder;  ///< holds pedestrian/, cyclist/, car/, bus/ with .nmea, .gpx or .csv files
  std::string stationary;  ///< recording of a receiver at rest, for R; empty: R of [radecki2016]
  int section = 50;        ///< fixes per section
  int sections = 100;      ///< drawn per class
  int draws = 20;
  double least_step = 0.25;  ///< [m] sections that move less on average are excluded [radecki2016]
  double pedestrian_recall = 0.97;  ///< of held-out training users, sets the pedestrian bias
  std::uint64_t seed = 1;
};

/// One recording.
struct GpsTrack {
  int mode = 0;                     ///< index into gpsModes()
  std::string user;                 ///< from the file's name: CLASS_USER_...; else the name itself
  std::vector<double> t;            ///< [s]
  std::vector<Vector2> p;           ///< [m]
  std::vector<int> bins;            ///< of SpeedRegimes, one fewer
  std::vector<std::size_t> starts;  ///< of sections whose mean step is at least least_step
};

/// pedestrian, cyclist, car, bus.
const std::vector<std::string>& gpsModes();
/// Throws DataError naming folder or file.
std::vector<GpsTrack> readGpsTracks(const GpsParams& params);

/// Models trained on a set of users.
struct GpsModel {
  std::vector<PaperClass> filters;    ///< by mode, noises by maximum likelihood
  std::vector<SpeedRegimes> regimes;  ///< by mode
  double pedestrian_bias = 0;         ///< added to the pedestrian's log likelihood
};

/// Classification rule for a section.
enum class GpsRule {
  kChi2,        ///< [radecki2016]: chi-square density of the filters' innovations
  kSequential,  ///< sequential likelihood of the same filters
  kRegimes,     ///< likelihood of the speed regimes, pedestrians favored
};

/// Confusion matrix and balanced accuracy.
struct GpsResult {
  std::vector<std::vector<double>> confusion;  ///< [truth][called], shares over all draws
  double balanced = 0, deviation = 0;  ///< mean and deviation of balanced accuracy over draws
  std::vector<double> right;           ///< by mode
};

/// The experiment: leave-one-user-out cross-validation.
struct GpsExperiment {
  std::vector<GpsTrack> tracks;
  std::vector<std::string> users;
  std::vector<GpsModel> models;  ///< by user: trained on the others
  Matrix2 R;
};
GpsExperiment prepareGps(const GpsParams& params);
GpsResult runGps(const GpsExperiment& experiment, const GpsParams& params, GpsRule rule);

StudyReport gpsStudy(const GpsParams& params);

}  // namespace perception
