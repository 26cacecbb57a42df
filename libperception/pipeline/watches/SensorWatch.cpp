#include "libperception/pipeline/watches/SensorWatch.h"

#include <fmt/format.h>

namespace perception {

SensorWatch::SensorWatch(const std::vector<PipelineSetup::Sensor>& sensors, double timeout,
                         EventLog& events)
    : sensors_(sensors), timeout_(timeout), events_(events), states_(sensors.size()) {
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    states_[i].record.label = sensors[i].label;
    states_[i].record.modality = std::string(1, letterOf(sensors[i].params.modality));
  }
}

void SensorWatch::countDroppedPoints(std::size_t sensor, std::uint64_t points) {
  states_[sensor].record.dropped_points += points;
}

void SensorWatch::addDroppedFrame(std::size_t sensor, std::optional<Stamp> stamp, const char* event,
                                  const std::string& why, bool warning) {
  ++states_[sensor].record.dropped_frames;
  const std::string text = sensors_[sensor].label + ": " + why;
  if (warning) {
    events_.warn(stamp, event, text);
  } else {
    events_.add(stamp, event, text);
  }
}

void SensorWatch::addFrame(std::size_t sensor, Stamp stamp, const MeasurementScan* scan) {
  State& state = states_[sensor];
  ++state.record.frames;
  if (scan == nullptr) return;
  state.record.measurements += scan->measurements.size();
  state.record.dropped_measurements += scan->dropped;
  state.record.dropped_points += scan->dropped_points;
  if (scan->dropped_points > 0 && !state.points_reported) {
    events_.warn(stamp, event_kind::kDroppedPoints,
                 fmt::format("{}: {} returns of a scan without a range or beyond max_points",
                             sensors_[sensor].label, scan->dropped_points));
    state.points_reported = true;
  }
}

void SensorWatch::setSeen(std::size_t sensor, Stamp stamp) {
  State& state = states_[sensor];
  if (state.lost) events_.add(stamp, event_kind::kSensorBack, sensors_[sensor].label + " is back");
  state.lost = false;
  state.last = stamp;
}

void SensorWatch::check(Stamp now) {
  for (State& s : states_) {
    if (s.lost || !s.last || now - *s.last <= timeout_) continue;
    s.lost = true;
    events_.warn(now, event_kind::kSensorLost,
                 fmt::format("{}: nothing for {:.3f} s", s.record.label, now - *s.last));
  }
}

void SensorWatch::restart(Stamp now) {
  for (State& s : states_) {
    if (s.last) s.last = now;
  }
}

void SensorWatch::finish() {
  for (std::size_t i = 0; i < states_.size(); ++i) {
    const SensorRecord& record = states_[i].record;
    if (!sensors_[i].used() || record.frames > 0) continue;
    const char* why =
        record.dropped_frames > 0 ? "none of its frames could be used" : "nothing of it in the log";
    events_.warn(std::nullopt, event_kind::kSensorMissing,
                 fmt::format("{}: in use by the configuration, but {}", record.label, why));
  }
  for (const auto& [label, frames] : ignored_) {
    events_.add(std::nullopt, event_kind::kSensorIgnored,
                label + ": in the log, but not in the configuration", {{"frames", frames}});
  }
}

std::vector<SensorRecord> SensorWatch::records() const {
  std::vector<SensorRecord> records;
  for (std::size_t i = 0; i < states_.size(); ++i) {
    if (sensors_[i].used()) records.push_back(states_[i].record);
  }
  return records;
}

}  // namespace perception
