#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libperception/pipeline/PipelineSetup.h"
#include "libperception/scene/EventLog.h"
#include "libperception/scene/RunRecord.h"

namespace perception {

/// What each sensor contributed, and events about it: lost, back, missing, data dropped.
/// `sensors` are those of the setup and outlive it; index: place in them.
class SensorWatch {
 public:
  /// `timeout` [s]: RunParams::sensor_timeout.
  SensorWatch(const std::vector<PipelineSetup::Sensor>& sensors, double timeout, EventLog& events);

  /// An observation of a label that no [sensor.LABEL] has.
  void countIgnored(const std::string& label) { ++ignored_[label]; }
  void countDroppedPoints(std::size_t sensor, std::uint64_t points);
  /// A frame that is not used; `warning`: worth a warning.
  void addDroppedFrame(std::size_t sensor, std::optional<Stamp> stamp, const char* event,
                       const std::string& why, bool warning);
  /// A frame that was used, for its ground plane only where `scan` is null.
  void addFrame(std::size_t sensor, Stamp stamp, const MeasurementScan* scan);
  /// That sensor spoke at this instant.
  void setSeen(std::size_t sensor, Stamp stamp);
  /// Reports sensors that have been silent for longer than the timeout.
  void check(Stamp now);
  /// The clock has jumped to this instant: those of before say nothing, and who spoke before is
  /// waited for from now on.
  void restart(Stamp now);
  /// Reports what is only known at the end: sensors that never spoke, labels of no sensor.
  void finish();
  /// Of the sensors used, in the order of the INI.
  std::vector<SensorRecord> records() const;

 private:
  struct State {
    SensorRecord record;
    std::optional<Stamp> last;
    bool lost = false;
    bool points_reported = false;  ///< that returns were dropped
  };

  const std::vector<PipelineSetup::Sensor>& sensors_;
  double timeout_;
  EventLog& events_;
  std::vector<State> states_;
  std::map<std::string, std::uint64_t> ignored_;  ///< frames by label
};

}  // namespace perception
