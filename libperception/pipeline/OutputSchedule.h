#pragma once
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "libperception/pipeline/PipelineSetup.h"

namespace perception {

/// When scenes are made: at the scans of one sensor or at a fixed rate, and how long each waits for
/// what is seen after it.
class OutputSchedule {
 public:
  /// An instant of which a scene is made.
  struct Instant {
    EgoState ego;
    std::int64_t frame = -1;
  };

  OutputSchedule(const RunParams& run, const std::vector<PipelineSetup::Sensor>& sensors);

  /// Place of the output sensor: the one named in [run], else the first in use of the modality with
  /// the largest output_rank.
  std::size_t sensor() const { return sensor_; }
  /// An instant with frames; `of_sensor`: one of them of the output sensor. True when a scene is to
  /// be made of it.
  bool isOutput(Stamp stamp, bool of_sensor);
  /// The next instant of the fixed rate before this one, once each.
  std::optional<Stamp> takeBefore(Stamp stamp);

  void push(const EgoState& ego, std::int64_t frame) { waiting_.push_back({ego, frame}); }
  /// The oldest instant whose lag is over; without `now` the oldest, as no more will be seen.
  std::optional<Instant> takeDue(std::optional<Stamp> now);
  /// Begins anew, as after a jump of the clock; those that wait stay.
  void restart() { next_.reset(); }

 private:
  double rate_, lag_;  ///< [Hz], 0: at scans; [s]
  std::size_t sensor_ = 0;
  std::optional<Stamp> next_;  ///< of the fixed rate
  std::deque<Instant> waiting_;
};

}  // namespace perception
