#include "libperception/pipeline/health/SensorHealth.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace perception {
namespace {

// All assumed.
constexpr double kDirty = 0.08, kDirtyFor = 0.4;  // [-], [s]
// Of the other sensors:
constexpr double kLogBlind = -11.5;  // ln 1e-5
constexpr double kFouledFrom = 8;    // log-likelihood ratio
constexpr double kLostFrom = 10;     // log-likelihood ratio, of a lidar's loss
constexpr double kFog = 0.2;

std::string hardlyFor(double seconds) {
  return fmt::format("hardly a return for {:.1f} s", seconds);
}

}  // namespace

SensorHealth::SensorHealth(const std::vector<PipelineSetup::Sensor>& sensors, EventLog& events)
    : sensors_(sensors), events_(events), states_(sensors.size()) {}

void SensorHealth::addFrame(std::size_t sensor, const SensorFrame& frame, double fog) {
  State& state = states_[sensor];
  bool empty = false;
  state.picture.add(frame);
  if (const auto* cloud = std::get_if<LidarCloud>(&frame.data)) {
    if (fog < kFog) judgeWindow(sensor, *cloud, frame.stamp);
    state.returns.add(cloud->size(), frame.stamp);
    empty = state.returns.empty();
    if (const auto blind = state.returns.blindFor(); blind && state.fault != Fault::kBlind)
      report(sensor, frame.stamp, Fault::kBlind, hardlyFor(*blind));
  } else if (const auto* radar = std::get_if<RadarReturns>(&frame.data)) {
    empty = radar->returns.empty();
  } else if (const auto* boxes = std::get_if<ObjectDetections>(&frame.data)) {
    empty = boxes->objects.empty();
  }
  if (empty) {
    if (!state.empty_since) state.empty_since = frame.stamp;
    return;
  }
  state.empty_since.reset();
  judgeFrozen(sensor, frame.stamp);
}

void SensorHealth::judgeFrozen(std::size_t sensor, Stamp stamp) {
  const State& state = states_[sensor];
  const auto frozen = state.picture.frozen();
  if (!frozen && state.fault == Fault::kBlind) report(sensor, stamp, Fault::kNone, "sees again");
  if (frozen && state.fault != Fault::kBlind)
    report(sensor, stamp, Fault::kBlind,
           fmt::format("the same frame for {:.1f} s and {:.0f} m of way", frozen->seconds,
                       frozen->meters));
}

void SensorHealth::addPart(std::size_t sensor, const SensorFrame& part) {
  const auto* cloud = std::get_if<LidarCloud>(&part.data);
  if (cloud == nullptr || !sensors_[sensor].active) return;
  State& state = states_[sensor];
  ReturnRate& returns = state.parts[part.sensor];
  returns.add(cloud->size(), part.stamp);
  const auto blind = returns.blindFor();
  if (blind && state.blind_parts.insert(part.sensor).second)
    write(sensor, part.sensor, part.stamp, Fault::kBlind, hardlyFor(*blind));
  if (!returns.empty() && state.blind_parts.erase(part.sensor) > 0)
    write(sensor, part.sensor, part.stamp, Fault::kNone, "sees again");
}

void SensorHealth::judgeWindow(std::size_t sensor, const LidarCloud& cloud, Stamp stamp) {
  State& state = states_[sensor];
  state.dirt.add(cloud, stamp);
  state.returns.addRoad(state.dirt.returns(), stamp);
  judgeLoss(sensor, stamp);
  const auto share = state.dirt.share();
  if (!share || *share < kDirty) {
    state.dirty_since.reset();
    if (share && state.fault == Fault::kFouled && *share < kDirty / 2 && state.returns.lost() <= 0)
      report(sensor, stamp, Fault::kNone, "its window is clear again");
    return;
  }
  if (!state.dirty_since) state.dirty_since = stamp;
  if (state.fault == Fault::kNone && stamp - *state.dirty_since >= kDirtyFor)
    report(sensor, stamp, Fault::kFouled,
           fmt::format("{:.0f} % of its window return nothing", 100 * *share));
}

void SensorHealth::judgeLoss(std::size_t sensor, Stamp stamp) {
  const State& state = states_[sensor];
  if (state.fault == Fault::kNone && state.returns.lost() > kLostFrom)
    report(sensor, stamp, Fault::kFouled,
           fmt::format("the road returns {:.0f} % of the usual", 100 * state.returns.left()));
}

void SensorHealth::addScan(std::size_t sensor, const MeasurementScan& scan,
                           const Hypothesis& tracks, const FilterModel& model,
                           const std::shared_ptr<const ClutterMap>& clutter, double seen_share) {
  State& state = states_[sensor];
  state.yaw = wrapAngle(yawOf(scan.state.T_world_sensor) - yawOf(scan.state.ego.T_world_ego));
  if (scan.modality == Modality::kLidar || !scan.model) return;
  if (state.empty_since) {
    state.doubt.passSilence(clutter);
  } else {
    state.doubt.hear(clutter);
  }
  state.doubt.add(scan, tracks, model, seen_share);
  judge(sensor, scan.state.stamp);
}

void SensorHealth::judge(std::size_t sensor, Stamp stamp) {
  State& state = states_[sensor];
  if (state.fault == Fault::kBlind) return;
  if (state.empty_since && state.doubt.logSilence() < kLogBlind) {
    const double empty = stamp - *state.empty_since;
    return report(sensor, stamp, Fault::kBlind,
                  fmt::format("nothing for {:.1f} s, which a healthy one would see", empty));
  }
  const double fouled = state.doubt.fouled();
  if (state.fault == Fault::kNone && fouled > kFouledFrom)
    return report(sensor, stamp, Fault::kFouled, "misses most of what other sensors see");
  if (state.fault == Fault::kFouled && fouled <= 0)
    return report(sensor, stamp, Fault::kNone, "sees what other sensors see");
  const auto offset = state.doubt.offset(stamp);
  if (state.fault == Fault::kNone && offset)
    report(sensor, stamp, Fault::kMisaligned,
           fmt::format("all that it sees is {:.1f} deg off to the {}", degrees(std::abs(*offset)),
                       *offset > 0 ? "left" : "right"));
}

double SensorHealth::coverage(Modality modality) const {
  int degrees_seen = 0;
  for (int bearing = 0; bearing < 360; ++bearing) {
    const auto sees = [&](std::size_t k) {
      const State& state = states_[k];
      return sensors_[k].active && sensors_[k].params.modality == modality &&
             state.fault != Fault::kBlind && state.yaw &&
             std::abs(wrapAngle(radians(bearing) - *state.yaw)) <= 0.5 * sensors_[k].params.fov;
    };
    bool seen = false;
    for (std::size_t k = 0; k < states_.size() && !seen; ++k) seen = sees(k);
    degrees_seen += seen;
  }
  return degrees_seen;
}

void SensorHealth::report(std::size_t sensor, Stamp stamp, Fault fault, const std::string& why) {
  states_[sensor].fault = fault;
  write(sensor, sensors_[sensor].label, stamp, fault, why);
}

void SensorHealth::write(std::size_t sensor, const std::string& label, Stamp stamp, Fault fault,
                         const std::string& why) {
  std::string remaining;
  for (std::size_t k = 0; k < states_.size(); ++k) {
    const char letter = letterOf(sensors_[k].params.modality);
    if (!sensors_[k].active || states_[k].fault == Fault::kBlind) continue;
    if (remaining.find(letter) == std::string::npos) remaining.push_back(letter);
  }
  std::sort(remaining.begin(), remaining.end());
  EventLog::Fields covers = EventLog::Fields::object();
  for (const char letter : remaining)
    covers[std::string(1, letter)] = coverage(static_cast<Modality>(letter));
  const Modality modality = sensors_[sensor].params.modality;
  EventLog::Fields fields = {{"sensor", label},
                             {"modality", std::string(1, letterOf(modality))},
                             {"remaining", remaining},
                             {"covers_deg", covers}};
  const std::string message = label + ": " + why;
  if (fault == Fault::kNone) {
    events_.add(stamp, event_kind::kSensorBack, message, std::move(fields));
  } else {
    const char* kind = fault == Fault::kBlind    ? event_kind::kSensorBlind
                       : fault == Fault::kFouled ? event_kind::kSensorFouled
                                                 : event_kind::kSensorMisaligned;
    events_.warn(stamp, kind, message, std::move(fields));
  }
}

void SensorHealth::restart() {
  for (State& state : states_) {
    State fresh;
    fresh.fault = state.fault, fresh.blind_parts = std::move(state.blind_parts);
    state = std::move(fresh);
  }
}

}  // namespace perception
