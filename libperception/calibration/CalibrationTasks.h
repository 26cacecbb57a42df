#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "libperception/config/Config.h"
#include "libperception/evaluation/tables/StudyReport.h"

namespace perception {

/// What a task of perception-calibrate works on.
struct CalibrationInput {
  std::vector<std::string> logs;   ///< rawlogs, with LOG.truth.csv beside each
  std::string config_file;         ///< INI of the vehicle
  std::function<Config()> config;  ///< reads that INI, with what overrides it
  double seconds = 0;              ///< of every log; 0: all
  std::uint64_t seed = 1;
};

/// How far labels and innovations count in the class update, searched in `rounds` rounds (0: its
/// own number); truth counts within `range` [m] and the angle `fov` [rad] ahead.
StudyReport calibrateTempering(const CalibrationInput& input, int rounds, double range, double fov);
/// What the scores of a 3D detector's boxes say of objects.
StudyReport calibrateBoxes(const CalibrationInput& input);
/// What those scores are worth, and the output threshold.
StudyReport calibrateConfidence(const CalibrationInput& input);
/// How true the odds of confidence = learnt are, and how soon; logs of one folder are of one
/// detector.
StudyReport calibrateLearnt(const CalibrationInput& input);
/// Detection, labels, clutter and noise of detectors, counted.
StudyReport calibrateDetector(const CalibrationInput& input);
/// The same of all sensors, with the log's own tracks where there is no truth, or always.
StudyReport calibrateGains(const CalibrationInput& input, bool without_truth);

struct LidarClassesOptions {
  std::vector<double> complete_fov{
      360};                   ///< [deg] in which the truth is complete: all, or one a log
  bool model_only = false;    ///< no tables
  std::string keep;           ///< model file of which all stays but the shapes that it knows
  std::string license, date;  ///< for the model file
};
/// What clusters of lidar returns look like, learned.
StudyReport calibrateLidarClasses(const CalibrationInput& input,
                                  const LidarClassesOptions& options);

}  // namespace perception
