#include "libperception/pipeline/SensorHealth.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace perception {
namespace {

// All assumed.
constexpr double kWindow = 1;           // [s] in which a direction with dirt returns nothing
constexpr std::size_t kLeastScans = 5;  // in it
constexpr std::size_t kStep = 7;        // of the returns every seventh is looked at
constexpr std::size_t kReach = 4;       // [deg] to the neighbors that return
constexpr double kLowest = -20;         // [deg] elevation of the lowest row
constexpr double kLeastRow = 0.1;       // share of a row's directions that return: it has beams
constexpr double kDirty = 0.08, kDirtyFor = 0.4;        // [-], [s]
constexpr double kFewReturns = 0.05;                    // of the usual ones
constexpr double kNoReturns = 20;                       // of a lidar of which nothing is known
constexpr double kUsualOver = 5;                        // [s] memory
constexpr double kBlindLidar = 1, kBlindFromStart = 3;  // [s] of empty frames
// Of the other sensors:
constexpr double kLogBlind = -11.5;  // ln 1e-5
constexpr double kFouledFrom = 8;    // log-likelihood ratio
constexpr double kFog = 0.2;

}  // namespace

void WindowDirt::add(const LidarCloud& cloud, Stamp stamp) {
  if (!first_) first_ = stamp;
  last_ = stamp;
  ++scans_;
  const float low = std::sin(static_cast<float>(radians(kLowest))),
              high = std::sin(static_cast<float>(radians(kLowest + static_cast<double>(kRows))));
  // Other ones in every scan, so that all directions are looked at.
  for (std::size_t i = scans_ % kStep; i < cloud.size(); i += kStep) {
    const float x = cloud.x[i], y = cloud.y[i], z = cloud.z[i];
    const float up = z / std::sqrt(x * x + y * y + z * z);
    if (!(up > low && up < high)) continue;
    const double row = degrees(std::asin(static_cast<double>(up))) - kLowest;
    const double column = degrees(std::atan2(static_cast<double>(y), static_cast<double>(x))) + 180;
    const auto r = std::min(static_cast<std::size_t>(row), kRows - 1);
    const auto c = static_cast<std::size_t>(column) % kColumns;
    seen_[r * kColumns + c] = stamp.ns;
  }
}

std::optional<double> WindowDirt::share() const {
  if (!first_ || last_ - *first_ < kWindow || scans_ < kLeastScans) return std::nullopt;
  const std::int64_t since = last_.ns - static_cast<std::int64_t>(1e9 * kWindow);
  std::size_t holes = 0, open = 0;
  for (std::size_t r = 0; r < kRows; ++r) {
    const auto sees = [&](std::size_t c) {
      return seen_[r * kColumns + c % kColumns] >= since && seen_[r * kColumns + c % kColumns] > 0;
    };
    std::size_t in_row = 0, holes_in_row = 0;
    for (std::size_t c = 0; c < kColumns; ++c) {
      in_row += sees(c);
      if (sees(c)) continue;
      bool left = false, right = false;
      for (std::size_t k = 1; k <= kReach; ++k)
        left = left || sees(c + k), right = right || sees(c + kColumns - k);
      holes_in_row += left && right;
    }
    if (static_cast<double>(in_row) < kLeastRow * kColumns) continue;
    open += in_row, holes += holes_in_row;
  }
  if (open == 0) return std::nullopt;
  return static_cast<double>(holes) / static_cast<double>(open + holes);
}

SensorHealth::SensorHealth(const std::vector<PipelineSetup::Sensor>& sensors, EventLog& events)
    : sensors_(sensors), events_(events), states_(sensors.size()) {}

// A lidar's scan is empty if hardly anything of the usual comes; other sensors' if nothing does.
bool SensorHealth::isEmpty(const SensorFrame& frame, State& state) const {
  if (const auto* radar = std::get_if<RadarReturns>(&frame.data)) return radar->returns.empty();
  if (const auto* boxes = std::get_if<ObjectDetections>(&frame.data)) return boxes->objects.empty();
  const auto* cloud = std::get_if<LidarCloud>(&frame.data);
  if (cloud == nullptr) return false;
  const auto count = static_cast<double>(cloud->size());
  const bool empty = state.usual > 0 ? count < kFewReturns * state.usual : count < kNoReturns;
  if (!empty) state.usual += (state.usual > 0 ? 0.1 / kUsualOver : 1) * (count - state.usual);
  return empty;
}

void SensorHealth::addFrame(std::size_t sensor, const SensorFrame& frame, double fog) {
  State& state = states_[sensor];
  const auto* cloud = std::get_if<LidarCloud>(&frame.data);
  if (cloud != nullptr && fog < kFog) judgeWindow(sensor, *cloud, frame.stamp);
  if (isEmpty(frame, state)) {
    if (!state.empty_since) state.empty_since = frame.stamp;
    ++state.empty_frames;
    if (cloud != nullptr) judgeBlindLidar(sensor, frame.stamp);
    return;
  }
  state.empty_since.reset();
  state.empty_frames = 0;
  if (state.fault == Fault::kBlind) report(sensor, frame.stamp, Fault::kNone, "sees again");
}

void SensorHealth::judgeWindow(std::size_t sensor, const LidarCloud& cloud, Stamp stamp) {
  State& state = states_[sensor];
  state.dirt.add(cloud, stamp);
  const auto share = state.dirt.share();
  if (!share || *share < kDirty) {
    state.dirty_since.reset();
    if (share && state.fault == Fault::kFouled && *share < kDirty / 2)
      report(sensor, stamp, Fault::kNone, "its window is clear again");
    return;
  }
  if (!state.dirty_since) state.dirty_since = stamp;
  if (state.fault == Fault::kNone && stamp - *state.dirty_since >= kDirtyFor)
    report(sensor, stamp, Fault::kFouled,
           fmt::format("{:.0f} % of its window return nothing", 100 * *share));
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

// A lidar that has returned something before and now hardly does, or never has.
void SensorHealth::judgeBlindLidar(std::size_t sensor, Stamp stamp) {
  const State& state = states_[sensor];
  if (state.fault == Fault::kBlind || state.empty_frames < kLeastScans) return;
  const double empty = stamp - *state.empty_since;
  if (empty < (state.usual > 0 ? kBlindLidar : kBlindFromStart)) return;
  report(sensor, stamp, Fault::kBlind, fmt::format("hardly a return for {:.1f} s", empty));
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
  const PipelineSetup::Sensor& s = sensors_[sensor];
  EventLog::Fields fields = {{"sensor", s.label},
                             {"modality", std::string(1, letterOf(s.params.modality))},
                             {"remaining", remaining},
                             {"covers_deg", covers}};
  const std::string message = s.label + ": " + why;
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
    const Fault fault = state.fault;
    state = State();
    state.fault = fault;
  }
}

}  // namespace perception
