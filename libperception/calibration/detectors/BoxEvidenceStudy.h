#pragma once
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "libperception/boxes3d/ConfidenceLearner.h"
#include "libperception/boxes3d/ScoreOdds.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/evaluation/tables/StudyReport.h"
#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/pipeline/input/RecordedLog.h"

namespace perception {

/// A detector's box with its true label.
struct BoxWithTruth {
  std::string label;  ///< the detector's class name
  BoxSample
      sample;  ///< `object`: true: on an object of the label's class; false: on no labeled object
  std::int64_t scan = 0;  ///< number since the log's begin
  double stated =
      std::numeric_limits<double>::quiet_NaN();  ///< log-odds of an object, as learned by then
};

/// All boxes of a log except those on objects of another class and in areas without labels.
struct BoxLog {
  std::string name;
  bool simulated = false;
  std::size_t scans = 0;  ///< that were compared with the truth
  std::vector<BoxWithTruth> boxes;
  std::vector<TruthObject> unlabeled;  ///< places in such areas: of the boxes there
};

/// Keys of [sensor.LABEL.positions] and their values.
using ScoreKeys = std::vector<std::pair<std::string, std::string>>;
/// score_slope, score_offset, score_fade and score_balance of a label.
ScoreKeys scoreKeys(const std::string& label, const ScoreOdds& odds, double balance);

/// Compares the boxes of `sensor` in `detections` with the truth of the same frame. A box is on an
/// object if the distance of their centers is less than a quarter of the object's length and 0.3 m;
/// in an area without labels if half of its image box or more is. `learner`, if any, sees all
/// frames and states what it holds of each box by then.
BoxLog boxLog(const RecordedLog& log, const std::string& sensor,
              const std::map<Stamp, ObjectDetections>& detections, const GroundTruth& truth,
              ConfidenceLearner* learner = nullptr);

/// Fits P(object | score, range) of every label; with leave-one-log-out cross-validation. Writes
/// the section for the vehicle's INI. `names`: maps the detector's class names to labels of the
/// INI; names not in it are unchanged.
StudyReport boxEvidenceStudy(const std::string& sensor, const std::vector<BoxLog>& logs,
                             const std::map<std::string, std::string>& names);

}  // namespace perception
