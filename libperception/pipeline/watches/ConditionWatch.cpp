#include "libperception/pipeline/watches/ConditionWatch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "libperception/core/math/LogMath.h"

namespace perception {
namespace {

// Time and later scans of the sensor after which an object has been seen again or is none: after
// four missed detections at P_D .6 the existence probability of a newborn falls by 40. Assumed.
constexpr double kLag = 1.5;  // [s]
constexpr std::size_t kLaterScans = 4;
constexpr double kClearFrom = 0.5;  // probability of clear air
constexpr double kBadShare = 0.6;   // of P_D that a camera has in bad weather. Assumed

/// P(exists) of the objects that were born in scan number `index`, by measurement.
std::vector<double> bornIn(std::uint64_t index, std::size_t measurements,
                           const CRbpfTracker& tracker) {
  std::vector<double> exists(measurements, 0), log_weights;
  for (const auto& p : tracker.m_particles) log_weights.push_back(p.log_w);
  const double all = logSumExp(log_weights);
  for (const auto& p : tracker.m_particles) {
    const double weight = std::exp(p.log_w - all);
    for (const TrackHandle& track : p.d->tracks) {
      const std::uint64_t k = track->id - birthId(index, 0);  // wraps for earlier births
      if (k < measurements) exists[static_cast<std::size_t>(k)] += weight * track->real();
    }
  }
  return exists;
}

}  // namespace

ConditionWatch::ConditionWatch(const std::vector<PipelineSetup::Sensor>& sensors,
                               const WeatherWatch& weather)
    : sensors_(sensors), weather_(weather), states_(sensors.size()) {
  for (std::size_t k = 0; k < sensors.size(); ++k)
    states_[k].map = std::make_shared<const ClutterMap>(sensors[k].params);
  const auto has = [&](Modality modality) {
    return std::any_of(sensors.begin(), sensors.end(), [&](const PipelineSetup::Sensor& s) {
      return s.active && s.params.modality == modality;
    });
  };
  weather_untold_ = !has(Modality::kLidar) && has(Modality::kRadar);
}

double ConditionWatch::apply(std::size_t sensor, MeasurementScan& scan,
                             const DetectionCount& count) const {
  SensorConditions conditions;
  if (sensors_[sensor].params.clutter == DetectionParams::Clutter::kLearnt)
    conditions.clutter = states_[sensor].map;
  if (sensors_[sensor].params.modality == Modality::kCamera &&
      (weather_untold_ || weather_.clear() < kClearFrom))
    conditions.seen_share = count.share(kBadShare);
  const double used = conditions.seen_share;
  if (!scan.model || (!conditions.clutter && used >= 1)) return 1;
  scan.model = std::make_shared<const ConditionedModel>(scan.model, std::move(conditions));
  return used;
}

void ConditionWatch::add(std::size_t sensor, const MeasurementScan& scan,
                         const CRbpfTracker& tracker, std::uint64_t index) {
  State& state = states_[sensor];
  Open open{index, scan.state.stamp, {}, {}};
  for (std::size_t k = 0; k < scan.measurements.size(); ++k) {
    open.unclaimed.push_back(std::clamp(1 - tracker.stats().of_tracks[k], 0.0, 1.0));
    open.cells.push_back(cellOf(scan.measurements[k], scan.state, state.map->cells()));
  }
  state.open.push_back(std::move(open));
  while (state.open.size() > kLaterScans && scan.state.stamp - state.open.front().stamp >= kLag)
    judge(tracker, state);
}

void ConditionWatch::judge(const CRbpfTracker& tracker, State& state) {
  const Open& open = state.open.front();
  const auto exists = bornIn(open.index, open.unclaimed.size(), tracker);
  std::vector<double> clutter(state.map->cells().size(), 0);
  for (std::size_t k = 0; k < open.unclaimed.size(); ++k)
    clutter[open.cells[k]] += std::max(0.0, open.unclaimed[k] - exists[k]);
  auto map = std::make_shared<ClutterMap>(*state.map);
  map->add(clutter, state.judged.ns != 0 ? open.stamp - state.judged : 0);
  state.map = std::move(map);
  state.judged = open.stamp;
  state.open.pop_front();
}

double ConditionWatch::clutterRate(std::size_t sensor) const {
  const DetectionParams& params = sensors_[sensor].params;
  return params.clutter == DetectionParams::Clutter::kLearnt ? states_[sensor].map->rate()
                                                             : params.clutter_per_scan;
}

std::vector<std::string> ConditionWatch::learned() const {
  std::vector<std::string> lines;
  for (std::size_t k = 0; k < states_.size(); ++k) {
    if (sensors_[k].params.clutter != DetectionParams::Clutter::kLearnt ||
        states_[k].judged.ns == 0)
      continue;
    lines.push_back("[sensor." + sensors_[k].label + "]");
    lines.push_back(fmt::format("clutter_per_scan = {:.2g}", states_[k].map->rate()));
  }
  return lines;
}

void ConditionWatch::restart() {
  for (State& state : states_) {
    state.open.clear();
    state.judged = {};
  }
}

}  // namespace perception
