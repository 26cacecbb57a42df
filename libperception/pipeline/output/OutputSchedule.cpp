#include "libperception/pipeline/output/OutputSchedule.h"

#include <algorithm>
#include <utility>

namespace perception {

OutputSchedule::OutputSchedule(const RunParams& run,
                               const std::vector<PipelineSetup::Sensor>& sensors)
    : rate_(run.output_rate),
      lag_(run.output_lag),
      timeout_(run.sensor_timeout),
      last_(sensors.size()) {
  const auto rank = [&](std::size_t i) {
    constexpr int kNamed = 1'000'000;
    const auto& s = sensors[i];
    return s.label == run.output_sensor ? kNamed : rowOf(s.params.modality).output_rank;
  };
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    if (sensors[i].active) by_rank_.push_back(i);
  }
  std::stable_sort(by_rank_.begin(), by_rank_.end(),
                   [&](std::size_t a, std::size_t b) { return rank(a) > rank(b); });
  if (!by_rank_.empty()) sensor_ = by_rank_.front();
}

void OutputSchedule::chooseSensor(Stamp stamp) {
  // Where nothing comes from any sensor, none of them is lost.
  if (!newest_ || stamp - *newest_ > timeout_) since_ = stamp;
  newest_ = stamp;
  const auto heard = [&](std::size_t i) {
    return stamp - std::max(*since_, last_[i].value_or(*since_)) <= timeout_;
  };
  const auto first = std::find_if(by_rank_.begin(), by_rank_.end(), heard);
  if (first != by_rank_.end()) sensor_ = *first;
}

bool OutputSchedule::isOutput(Stamp stamp) {
  chooseSensor(stamp);
  if (rate_ <= 0) return !by_rank_.empty() && last_[sensor_] == stamp;
  if (!next_) next_ = stamp;
  return false;
}

void OutputSchedule::restart() {
  next_.reset();
  newest_.reset();
  std::fill(last_.begin(), last_.end(), std::nullopt);
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
