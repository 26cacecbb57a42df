#pragma once
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "libperception/core/GroundTruth.h"
#include "libperception/pipeline/input/RecordedLog.h"

namespace perception {

/// Error of one measured quantity of a detection.
struct DetectorError {
  ClassId class_id = -1;
  std::string quantity;  ///< left, right [rad]; range, across, height, base, length, width [m] ...
  double range = 0;      ///< [m] of the object's center from the sensor
  double error = 0;      ///< measured minus true
  double sigma = 1;      ///< standard deviation stated by the front end
  std::size_t log = 0;
  std::int64_t object = -1;
  double t = 0;  ///< [s]
};

/// One labeled object in the sensor's view at one instant: detected or not.
struct DetectorChance {
  ClassId class_id = -1;
  int occluded = 0;   ///< KITTI: 0 visible, 1 partly, 2 largely
  double range = 0;   ///< [m]
  int label = -1;     ///< of the detection on it; -1: none
  double stated = 0;  ///< P_D by the INI
  std::size_t log = 0;
  double t = 0;  ///< [s]
};

/// Detections of one scan on no labeled object.
struct ClutterCount {
  std::size_t log = 0;
  double t = 0;  ///< [s]
  std::size_t number = 0;
  std::size_t entered = 0;  ///< labeled objects that the sensor had not detected before
};

/// Statistics of one sensor's detections against labeled objects.
struct DetectorCounts {
  std::string sensor;
  Modality modality = Modality::kLidar;
  std::size_t scans = 0,
              first_seen = 0;  ///< number of scans; number of labeled objects that were detected
  std::vector<DetectorChance> chances;
  std::vector<DetectorError> errors;
  std::vector<std::size_t> clutter;         ///< by label: detections on no labeled object
  std::vector<ClutterCount> clutter_scans;  ///< the same by scan
  std::vector<std::vector<double>> label;   ///< [class][label] of the INI
};

/// Adds the counts of all sensors of a log. Detections are matched one-to-one, nearest first by
/// normalized distance with four times the stated standard deviations; those within 2 m or half an
/// object's size of an unmatched label of any type are not counted as clutter. `labels`: how many
/// labels each sensor has. Labels are those of the scan's frame, else of its time (alignTruth()).
/// If a label does not say how far an object is hidden, the latest scan with an occlusion map says
/// so; without such a scan the object does not count as a chance to be detected.
void countDetections(const RecordedLog& log, const GroundTruth& truth, std::size_t log_index,
                     const std::map<std::string, std::size_t>& labels,
                     std::map<std::string, DetectorCounts>& counts);

/// Mean, rms, stated standard deviation and mean NIS of errors; `repeated`: correlation of the
/// normalized errors of one object one second apart.
struct ErrorFigures {
  std::size_t count = 0;
  double mean = 0, rms = 0, stated = 0, nis = 0, repeated = 0;
};
ErrorFigures figuresOf(const std::vector<const DetectorError*>& errors);

}  // namespace perception
