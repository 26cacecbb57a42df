#pragma once
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "libperception/pipeline/PipelineSetup.h"
#include "libperception/pipeline/safety/SafetyMonitor.h"

namespace perception {

/// Stamps of the scenes: at the scans of one sensor or at a fixed rate, delayed by the smoothing
/// lag.
class OutputSchedule {
 public:
  /// A scene to be made.
  struct Instant {
    EgoState ego;
    std::int64_t frame = -1;
    PathAhead path;                                 ///< ahead, as of this instant
    std::optional<FreePath> advice = std::nullopt;  ///< as of this instant, if the scene is later
  };

  OutputSchedule(const RunParams& run, const std::vector<PipelineSetup::Sensor>& sensors);

  /// Index of the output sensor: the one named in [run] output_sensor, else the first one in use of
  /// the modality with the largest output_rank. While it is silent for longer than sensor_timeout
  /// and others are not, the next one in this order.
  std::size_t sensor() const { return sensor_; }
  /// A frame of this sensor at `stamp` was processed.
  void addFrame(std::size_t sensor, Stamp stamp) { last_[sensor] = stamp; }
  /// Called once the frames of `stamp` are processed. Without a fixed rate: whether a scene is due
  /// at `stamp`, which is so when one of these frames is of the output sensor. With a fixed rate:
  /// always false, see takeBefore(); the first call, also after restart(), starts the rate at
  /// `stamp`.
  bool isOutput(Stamp stamp);
  /// The next instant of the fixed rate if it is before `stamp`; call until empty.
  std::optional<Stamp> takeBefore(Stamp stamp);

  void push(Instant instant) { waiting_.push_back(std::move(instant)); }
  /// The oldest waiting instant whose lag has passed at `now`; without `now` (end of log) the
  /// oldest.
  std::optional<Instant> takeDue(std::optional<Stamp> now);
  /// Restarts the fixed rate, as after a clock jump; waiting instants are kept.
  void restart();

 private:
  void chooseSensor(Stamp stamp);

  double rate_, lag_, timeout_;       ///< [Hz], 0: at scans; [s]; [s] of silence
  std::vector<std::size_t> by_rank_;  ///< sensors in use, the preferred output sensor first
  std::size_t sensor_ = 0;
  std::vector<std::optional<Stamp>> last_;  ///< newest frame by sensor
  std::optional<Stamp> newest_, since_;     ///< newest frame; since when frames come without a gap
  std::optional<Stamp> next_;               ///< of the fixed rate
  std::deque<Instant> waiting_;
};

}  // namespace perception
