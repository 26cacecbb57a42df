#include "libperception/pipeline/OutputSchedule.h"

#include <utility>

namespace perception {

OutputSchedule::OutputSchedule(const RunParams& run,
                               const std::vector<PipelineSetup::Sensor>& sensors)
    : rate_(run.output_rate), lag_(run.output_lag) {
  const auto rank = [&](const PipelineSetup::Sensor& s) {
    constexpr int kNamed = 1'000'000;
    if (!s.active) return -1;
    return s.label == run.output_sensor ? kNamed : rowOf(s.params.modality).output_rank;
  };
  for (std::size_t i = 1; i < sensors.size(); ++i) {
    if (rank(sensors[i]) > rank(sensors[sensor_])) sensor_ = i;
  }
}

bool OutputSchedule::isOutput(Stamp stamp, bool of_sensor) {
  if (rate_ <= 0) return of_sensor;
  if (!next_) next_ = stamp;
  return false;
}

std::optional<Stamp> OutputSchedule::takeBefore(Stamp stamp) {
  if (!next_ || !(*next_ < stamp)) return std::nullopt;
  return std::exchange(next_, *next_ + 1 / rate_);
}

std::optional<OutputSchedule::Instant> OutputSchedule::takeDue(std::optional<Stamp> now) {
  if (waiting_.empty() || (now && *now - waiting_.front().ego.stamp < lag_)) return std::nullopt;
  Instant instant = std::move(waiting_.front());
  waiting_.pop_front();
  return instant;
}

}  // namespace perception
