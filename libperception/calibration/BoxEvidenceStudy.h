#pragma once
#include <map>
#include <string>
#include <vector>

#include "libperception/boxes3d/ScoreOdds.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/evaluation/StudyReport.h"
#include "libperception/measurement/SensorFrame.h"
#include "libperception/pipeline/RecordedLog.h"

namespace perception {

/// One box of a detector and what it turned out to be.
struct JudgedBox {
  std::string label;  ///< the detector's class name
  BoxSample sample;   ///< `object`: on an object of the label's class; else on nothing labeled
};

/// All boxes of a log that can be judged: not those on objects of another class.
struct BoxLog {
  std::string name;
  bool simulated = false;
  std::vector<JudgedBox> boxes;
};

/// Judges the boxes of sensor `sensor` in `detections` by the truth of the same frame. A box is on
/// an object whose center it misses by less than a quarter of the object's length and 0.3 m.
BoxLog boxLog(const RecordedLog& log, const std::string& sensor,
              const std::map<Stamp, ObjectDetections>& detections, const GroundTruth& truth);

/// Fits P(object | score, range) of every label; each log is also judged by what was fitted on the
/// others. Writes the section for the vehicle's INI.
/// `names`: the INI's label of each of the detector's class names; those without stay as they are.
StudyReport boxEvidenceStudy(const std::string& sensor, const std::vector<BoxLog>& logs,
                             const std::map<std::string, std::string>& names);

}  // namespace perception
