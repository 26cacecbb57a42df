#pragma once
#include <optional>
#include <string>
#include <vector>

namespace perception {

/// A row of the tables of tracking results of [radecki2016]: one condition.
struct PaperTrackingRow {
  const char* table;      ///< short name, as given to --paper: sunny, particles, pedestrian ...
  const char* condition;  ///< weather, number of particles or kind of object
  const char* sensors;    ///< C+L+R
  double tracked;         ///< Object Tracked
  double range;           ///< [m] Range Error
  double bearing;         ///< [rad] Bearing Error
  double correct, mis;    ///< Correct Classification, Mis-Classification
  int returns;            ///< Number of Returns
};

/// A row of the table of recall and precision of [radecki2016], with the precision by size given in
/// its text. All in [0, 1]; empty: not published.
struct PaperFrontEndRow {
  const char* sensor;
  const char* condition;
  std::optional<double> car_recall, car_size_precision, car_precision;
  std::optional<double> person_recall, person_size_precision, person_precision;
};

/// A row of the second particle study of [radecki2016]: rms errors of the number of objects against
/// 50 particles.
struct PaperParticlesRow {
  int particles;
  double duc;              ///< configuration 1: DUC's tracker
  double all, classified;  ///< configuration 2: with classification
};

/// A row of the two tables of rates of [radecki2016]: objects detected per sensor return, mean
/// number of objects tracked.
struct PaperRateRow {
  const char* sensors;
  bool tracked;  ///< false: objects detected
  double objects, cars, persons;
};

/// "Joint Data Association, Tracking, and Classification ... in Weather": tables results_particles,
/// results_person, results_suburban, results_lidar, results_camera, results_full.
const std::vector<PaperTrackingRow>& paperTrackingRows();
/// Table Recall-Precision and section "Sensor Performance".
const std::vector<PaperFrontEndRow>& paperFrontEndRows();
/// Table Particle-stats.
const std::vector<PaperParticlesRow>& paperParticlesRows();
/// Tables Detection-Rate and Tracking-Rate: the uncontrolled drive.
const std::vector<PaperRateRow>& paperRateRows();

/// Whether a simulated log's weather (RunRecord) is that of the table of rows: sunny (clear air,
/// too) and particles, night, wet (no precipitation), snow; pedestrian and vehicle are of all
/// weathers.
bool paperTableHasWeather(const std::string& table, const std::string& weather);
/// The same of the conditions of paperFrontEndRows(): Sunny, Rainy.
bool paperConditionHasWeather(const std::string& condition, const std::string& weather);

/// Names that --paper takes.
std::vector<std::string> paperTableNames();
/// The rows of these tables. Throws Error (kUsage) for another name.
std::vector<PaperTrackingRow> paperRowsOf(const std::vector<std::string>& tables);

}  // namespace perception
