#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libperception/pipeline/PipelineSetup.h"
#include "libperception/scene/files/EventLog.h"
#include "libperception/scene/files/RunRecord.h"

namespace perception {

/// Statistics of each sensor, and events: lost, back, missing, data dropped. Indices refer to
/// `sensors`, which must outlive this.
class SensorWatch {
 public:
  /// `timeout` [s]: RunParams::sensor_timeout.
  SensorWatch(const std::vector<PipelineSetup::Sensor>& sensors, double timeout, EventLog& events);

  /// Counts an observation whose label has no [sensor.LABEL].
  void countIgnored(const std::string& label) { ++ignored_[label]; }
  void countDroppedPoints(std::size_t sensor, std::uint64_t points);
  /// A frame that is not used; `warning`: severity of the event.
  void addDroppedFrame(std::size_t sensor, std::optional<Stamp> stamp, const char* event,
                       const std::string& why, bool warning);
  /// A frame that was used; `scan` is null if only for its ground plane.
  void addFrame(std::size_t sensor, Stamp stamp, const MeasurementScan* scan);
  /// The sensor had a frame at this stamp.
  void setSeen(std::size_t sensor, Stamp stamp);
  /// Reports sensors without frames for longer than the timeout.
  void check(Stamp now);
  /// After a clock jump to `now`: clears the stamps of the last frames; sensors that had frames
  /// before are expected from now on.
  void restart(Stamp now);
  /// Reports events known at the end of the log: sensors without frames, labels without a section.
  void finish();
  /// Of the sensors in use, in the order of the INI.
  std::vector<SensorRecord> records() const;

 private:
  struct State {
    SensorRecord record;
    std::optional<Stamp> last;
    bool lost = false;
    bool points_reported = false;  ///< an event about dropped returns was written
  };

  const std::vector<PipelineSetup::Sensor>& sensors_;
  double timeout_;
  EventLog& events_;
  std::vector<State> states_;
  std::map<std::string, std::uint64_t> ignored_;  ///< frames by label
};

}  // namespace perception
