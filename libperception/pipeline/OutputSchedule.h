#pragma once
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "libperception/pipeline/PipelineSetup.h"
#include "libperception/pipeline/SafetyMonitor.h"

namespace perception {

/// Stamps of the scenes: at the scans of one sensor or at a fixed rate, delayed by the smoothing
/// lag.
class OutputSchedule {
 public:
  /// A scene to be made.
  struct Instant {
    EgoState ego;
    std::int64_t frame = -1;
    PathAhead path;  ///< ahead, as of this instant
  };

  OutputSchedule(const RunParams& run, const std::vector<PipelineSetup::Sensor>& sensors);

  /// Index of the output sensor: the one named in [run] output_sensor, else the first one in use of
  /// the modality with the largest output_rank.
  std::size_t sensor() const { return sensor_; }
  /// Called once the frames of `stamp` are processed. Without a fixed rate: whether a scene is due
  /// at `stamp`, which is so when one of these frames is of the output sensor (`of_sensor`). With a
  /// fixed rate: always false, see takeBefore(); the first call, also after restart(), starts the
  /// rate at `stamp`.
  bool isOutput(Stamp stamp, bool of_sensor);
  /// The next instant of the fixed rate if it is before `stamp`; call until empty.
  std::optional<Stamp> takeBefore(Stamp stamp);

  void push(Instant instant) { waiting_.push_back(std::move(instant)); }
  /// The oldest waiting instant whose lag has passed at `now`; without `now` (end of log) the
  /// oldest.
  std::optional<Instant> takeDue(std::optional<Stamp> now);
  /// Restarts the fixed rate, as after a clock jump; waiting instants are kept.
  void restart() { next_.reset(); }

 private:
  double rate_, lag_;  ///< [Hz], 0: at scans; [s]
  std::size_t sensor_ = 0;
  std::optional<Stamp> next_;  ///< of the fixed rate
  std::deque<Instant> waiting_;
};

}  // namespace perception
