#pragma once
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "libperception/core/GroundTruth.h"
#include "libperception/pipeline/RecordedLog.h"

namespace perception {

/// One quantity of a detection against the truth of the object that it lies on.
struct DetectorError {
  ClassId class_id = -1;
  std::string quantity;  ///< left, right [rad]; range, across, height, base, length, width [m] ...
  double range = 0;      ///< [m] of the object's center from the sensor
  double error = 0;      ///< measured less true
  double sigma = 1;      ///< as the front end states it
  std::size_t log = 0;
  std::int64_t object = -1;
  double t = 0;  ///< [s]
};

/// One labeled object at one instant in the sensor's view: seen or not.
struct DetectorChance {
  ClassId class_id = -1;
  int occluded = 0;   ///< KITTI: 0 visible, 1 partly, 2 largely
  double range = 0;   ///< [m]
  int label = -1;     ///< of the detection on it; -1: none
  double stated = 0;  ///< P_D that the INI gives
};

/// What one sensor's detections are, held against labeled objects.
struct DetectorCounts {
  std::string sensor;
  Modality modality = Modality::kLidar;
  std::size_t scans = 0, first_seen = 0;  ///< scans; labeled objects that came into view
  std::vector<DetectorChance> chances;
  std::vector<DetectorError> errors;
  std::vector<std::size_t> clutter;        ///< by label: detections on nothing labeled
  std::vector<std::vector<double>> label;  ///< [class][label] as the INI says
};

/// Adds what a log's scans of every sensor show. Detections are matched one to one, nearest first
/// by their normalized distance under the stated noise, with deviations four times as large; those
/// within 2 m or half an object's size of an unmatched label of any type are no clutter.
/// `labels`: how many labels each sensor has.
void countDetections(const RecordedLog& log, const GroundTruth& truth, std::size_t log_index,
                     const std::map<std::string, std::size_t>& labels,
                     std::map<std::string, DetectorCounts>& counts);

/// Mean, root mean square, stated deviation and normalized square of errors; `repeated` is the
/// correlation of the normalized errors of one object a second apart.
struct ErrorFigures {
  std::size_t count = 0;
  double mean = 0, rms = 0, stated = 0, nis = 0, repeated = 0;
};
ErrorFigures figuresOf(const std::vector<const DetectorError*>& errors);

}  // namespace perception
