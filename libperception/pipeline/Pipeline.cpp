#include "libperception/pipeline/Pipeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "libperception/boxes3d/PositionFrontEnd.h"
#include "libperception/filter/update/LanePrior.h"
#include "libperception/lidar/LidarFrontEnd.h"
#include "libperception/radar/RadarFrontEnd.h"
#include "libperception/sensors/Conversions.h"
#include "libperception/vision/VisionFrontEnd.h"

namespace perception {
namespace {

/// A row per kind of front end: [sensor.LABEL] kind.
struct FrontEndRow {
  const char* kind;
  std::unique_ptr<FrontEnd> (*make)(Config&, const std::string& label, const ClassTable&);
};
constexpr FrontEndRow kFrontEnds[] = {
    {"lidar", &makeLidarFrontEnd},
    {"boxes", &makeVisionFrontEnd},
    {"radar", &makeRadarFrontEnd},
    {"positions", &makePositionFrontEnd},
};

constexpr double kSameInstant =
    1e-3;  // [s] a frame number holds for frames this near to its comment
constexpr double kOcclusionMapAge =
    0.2;  // [s] a lidar's horizon serves the other sensors for so long
constexpr double kEgoGapDrift =
    1.0;  // [m/s] growth of the position's deviation while no pose comes

std::shared_ptr<const FrontEnd> makeFrontEnd(Config& config, const std::string& section,
                                             const std::string& label, const std::string& kind,
                                             const ClassTable& classes) {
  std::string known;
  for (const auto& row : kFrontEnds) {
    if (kind == row.kind) return row.make(config, label, classes);
    known += (known.empty() ? "" : ", ") + std::string(row.kind);
  }
  config.fault(section, "kind", "unknown front end '" + kind + "', known are: " + known);
  return nullptr;
}

/// "C+L" -> "CL"; anything but C, C/H, L, R joined by + is a fault. C/H: a camera whose headings
/// are one wide Gaussian, the paper's baseline.
bool readModalities(const std::string& text, std::string& letters, bool& wide_heading) {
  constexpr const char* kCameraHeading = "C/H";
  letters.clear();
  wide_heading = false;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find('+', at), text.size());
    const std::string word = text.substr(at, end - at);
    const bool heading = word == kCameraHeading;
    if (!heading && word != "C" && word != "L" && word != "R") return false;
    letters += word[0];
    wide_heading = wide_heading || heading;
    at = end + 1;
  }
  return true;
}

}  // namespace

const std::vector<std::string>& RunParams::associationNames() {
  static const std::vector<std::string> names = {"sampled", "ranked", "nearest"};
  return names;
}

void RunParams::visit(ParamVisitor& v) {
  v.unsigned64("seed", seed, "of all random numbers; --seed wins");
  v.text("sensors", sensors,
         "modalities in use: C, C/H (camera headings as one wide Gaussian), L, R joined by +; "
         "--sensors wins");
  v.words("without", without, "labels of sensors that are left out all the same; none");
  v.choiceOf("association", association, associationNames(),
             "how a hypothesis chooses the causes of measurements");
  v.text("output_sensor", output_sensor,
         "scenes at its scans; empty: the first lidar in use, else the first sensor");
  v.real("output_rate", output_rate, {0, 1000}, "Hz",
         "scenes at a fixed rate instead; 0: at scans; --rate wins");
  v.real("output_lag", output_lag, {0, 10}, "s",
         "scenes come so late, smoothed by what was seen meanwhile; 0: at once");
  v.real("reorder_window", reorder_window, {0, 10}, "s", "how late an observation may come");
  v.real("sensor_timeout", sensor_timeout, {0.01, 1e4}, "s",
         "silence after which a sensor counts as lost");
  v.real("clock_jump", clock_jump, {0.1, 1e6}, "s",
         "step of the clock that starts anew (back) or is reported (forward)");
  v.boolean("write_measurements", write_measurements,
            "what the front ends found goes into measurements.csv, scans.csv and sensors.csv; "
            "--measurements wins");
}

PipelineSetup PipelineSetup::read(Config& config) {
  PipelineSetup s;
  s.run = config.read<RunParams>("run");
  s.model.classes = readClassTable(config);
  s.model.params = config.read<FilterParams>("filter");
  s.model.proposal = s.run.association;
  s.model.history = s.run.output_lag;
  const auto lanes = config.read<LaneParams>("lanes");
  if (!lanes.file.empty())
    s.model.lanes = std::make_shared<const LanePrior>(LaneMap::fromFile(lanes.file), lanes);
  s.particles = config.read<ParticleFilterParams>("particle_filter");
  s.scene = config.read<SceneParams>("scene");
  s.ego = config.read<EgoPoseParams>("ego");
  s.ground = config.read<GroundParams>("ground");
  s.weather = WeatherParams::read(config);
  s.grid = config.read<GridParams>("grid");
  std::string letters;
  bool wide_heading = false;
  if (!readModalities(s.run.sensors, letters, wide_heading)) {
    config.fault("run", "sensors",
                 "'" + s.run.sensors + "' is not a list of C, C/H, L, R joined by + (as C+L)");
  }
  if (letters.find('L') == std::string::npos) s.scene.place_within = 0;  // see SceneParams
  if (wide_heading) s.model.params.heading = HeadingMode::kWide;
  const std::string prefix = "sensor.";
  for (const auto& section : config.sectionsWithPrefix(prefix)) {
    Sensor sensor;
    sensor.label = section.substr(prefix.size());
    if (sensor.label.find('.') != std::string::npos) continue;  // a table of that sensor
    sensor.params = config.read<DetectionParams>(section);
    if (sensor.params.kind == "lidar") sensor.scan = config.read<ScanParams>(section);
    if (!sensor.scan.merge.empty() && sensor.scan.merge_window > s.run.reorder_window)
      config.fault(section, "merge_window", "must not be above [run] reorder_window");
    if (!sensor.scan.merge.empty() && sensor.params.pose)
      config.fault(section, "pose", "several scanners are merged: their poses come with the log");
    sensor.front_end =
        makeFrontEnd(config, section, sensor.label, sensor.params.kind, s.model.classes);
    const auto& without = s.run.without;
    sensor.active = letters.find(static_cast<char>(sensor.params.modality)) != std::string::npos &&
                    std::find(without.begin(), without.end(), sensor.label) == without.end();
    s.sensors.push_back(std::move(sensor));
  }
  for (const auto& label : s.run.without) {
    if (label == "none") continue;
    const auto is_it = [&](const Sensor& sensor) { return sensor.label == label; };
    if (std::none_of(s.sensors.begin(), s.sensors.end(), is_it))
      config.fault("run", "without", "there is no [sensor." + label + "]");
  }
  const auto active = [](const Sensor& sensor) { return sensor.active; };
  if (std::none_of(s.sensors.begin(), s.sensors.end(), active)) {
    config.fault("run", "sensors",
                 "no [sensor.LABEL] section has a modality of '" + s.run.sensors + "'");
  }
  const auto named = [&](const Sensor& sensor) {
    return sensor.label == s.run.output_sensor && sensor.active;
  };
  if (!s.run.output_sensor.empty() && std::none_of(s.sensors.begin(), s.sensors.end(), named)) {
    config.fault("run", "output_sensor", "'" + s.run.output_sensor + "' is not a sensor in use");
  }
  return s;
}

Pipeline::Pipeline(PipelineSetup setup, EventLog& events, RunTiming& timing)
    : setup_(std::move(setup)),
      events_(events),
      timing_(timing),
      tracker_(setup_.model, setup_.particles.toMrpt(), setup_.run.seed),
      scenes_(setup_.model, setup_.scene),
      ego_(setup_.ego),
      queue_({setup_.run.reorder_window, 70}) {
  for (const auto& sensor : setup_.sensors) {
    SensorState state;
    state.record.label = sensor.label;
    state.record.modality = std::string(1, static_cast<char>(sensor.params.modality));
    if (sensor.params.modality == Modality::kLidar && sensor.scan.ground) {
      state.ground = std::make_unique<GroundEstimator>(setup_.ground, setup_.run.seed);
      state.weather = makePointFilter(setup_.weather);
    }
    states_.push_back(std::move(state));
  }
  // Scenes come at the named sensor's scans, else at the first lidar's, else at the first sensor's
  // in use.
  const auto rank = [&](const PipelineSetup::Sensor& s) {
    if (!s.active) return 0;
    return s.label == setup_.run.output_sensor ? 3 : s.params.modality == Modality::kLidar ? 2 : 1;
  };
  for (std::size_t i = 1; i < setup_.sensors.size(); ++i) {
    if (rank(setup_.sensors[i]) > rank(setup_.sensors[output_sensor_])) output_sensor_ = i;
  }
}

int Pipeline::sensorIndex(const std::string& label) const {
  for (std::size_t i = 0; i < setup_.sensors.size(); ++i) {
    if (setup_.sensors[i].label == label || setup_.sensors[i].scan.merges(label))
      return static_cast<int>(i);
  }
  return -1;
}

// Scans of several scanners, at most merge_window apart, become one frame at the newest one's time.
void Pipeline::mergeScans(std::vector<SensorFrame>& frames) {
  if (frames.empty()) return;
  const Stamp stamp = frames.front().stamp;
  for (const auto& sensor : setup_.sensors) {
    const auto others =
        std::stable_partition(frames.begin(), frames.end(), [&](const SensorFrame& f) {
          return f.sensor == sensor.label || !sensor.scan.merges(f.sensor);
        });
    if (others == frames.end()) continue;
    std::vector<SensorFrame> scans(std::make_move_iterator(others),
                                   std::make_move_iterator(frames.end()));
    frames.erase(others, frames.end());
    const auto missing = [&](const std::string& label) {
      return sensor.scan.merges(label) &&
             std::none_of(scans.begin(), scans.end(),
                          [&](const SensorFrame& f) { return f.sensor == label; });
    };
    for (auto& scan : queue_.take(stamp + sensor.scan.merge_window, missing)) {
      if (missing(scan.sensor)) scans.push_back(std::move(scan));
    }
    std::sort(scans.begin(), scans.end(),
              [](const SensorFrame& a, const SensorFrame& b) { return a.sensor < b.sensor; });
    SensorFrame merged = mergedScan(scans, sensor.label);
    if (merged.stamp == stamp) {
      frames.push_back(std::move(merged));
    } else {
      queue_.push(std::move(merged));
    }
  }
}

void Pipeline::add(const mrpt::obs::CObservation& observation) {
  const auto stamp = toStamp(observation.timestamp);
  if (stamp) addTime(*stamp);
  if (const auto number = frameNumber(observation)) {
    if (stamp) frame_numbers_.emplace_back(*stamp, *number);
    if (frame_numbers_.size() > 200) frame_numbers_.pop_front();
    return;
  }
  if (isImage(observation)) return;  // no front end reads images: their boxes come as detections
  if (isSensorData(observation)) {
    addFrame(observation);
  } else {
    ego_.add(observation);
  }
}

void Pipeline::addTime(Stamp stamp) {
  if (!first_stamp_) first_stamp_ = stamp;
  if (last_stamp_.ns != 0 && last_stamp_ - stamp > setup_.run.clock_jump)
    startEpoch(stamp, last_stamp_ - stamp);
  if (last_stamp_.ns != 0 && stamp - last_stamp_ > setup_.run.clock_jump) {
    // Before the first pose behind the gap comes: it would push the poses of these frames out.
    while (!queue_.empty()) {
      auto frames = queue_.pop(true);
      mergeScans(frames);
      processInstant(std::move(frames));
    }
    events_.add(stamp, event_kind::kClockJump,
                fmt::format("nothing for {:.3f} s", stamp - last_stamp_));
  }
  last_stamp_ = std::max(last_stamp_, stamp);
  queue_.advance(stamp);
}

void Pipeline::startEpoch(Stamp stamp, double back) {
  while (!queue_.empty()) {
    auto frames = queue_.pop(true);
    mergeScans(frames);
    processInstant(std::move(frames));
  }
  events_.warn(stamp, event_kind::kClockJump,
               fmt::format("the clock went back by {:.3f} s: tracks start anew", back));
  restartTracks();
  ego_.clear();
  queue_.clear();
  frame_numbers_.clear();
  next_output_.reset();
  last_instant_.reset();
  for (auto& s : states_) s.last.reset();
  last_stamp_ = stamp;
}

void Pipeline::addFrame(const mrpt::obs::CObservation& observation) {
  const int index = sensorIndex(observation.sensorLabel);
  if (index < 0) {
    ++ignored_[observation.sensorLabel];
    return;
  }
  const auto& sensor = setup_.sensors[static_cast<std::size_t>(index)];
  if (!sensor.active) return;
  const auto scope = timing_.stage("decode");
  SensorRecord& record = states_[static_cast<std::size_t>(index)].record;
  DecodeCounts counts;
  auto frame = frameFromObservation(observation, &counts);
  record.dropped_points += counts.dropped();
  if (!frame) {
    ++record.dropped_frames;
    events_.warn(toStamp(observation.timestamp), event_kind::kDroppedFrame,
                 fmt::format("{}: an observation that cannot be used", sensor.label));
    return;
  }
  if (sensor.params.pose) frame->T_ego_sensor = *sensor.params.pose;
  const Stamp stamp = frame->stamp;
  switch (queue_.push(std::move(*frame))) {
    case FrameQueue::Verdict::kTaken:
      break;
    case FrameQueue::Verdict::kDuplicate:
      ++record.dropped_frames;
      events_.add(stamp, event_kind::kDroppedFrame,
                  sensor.label + ": a second frame of the same instant");
      break;
    case FrameQueue::Verdict::kTooLate:
      ++record.dropped_frames;
      events_.warn(stamp, event_kind::kOutOfOrder,
                   sensor.label + ": older than the reorder window");
      break;
  }
}

std::optional<Scene> Pipeline::next(bool flush) {
  while (ready_.empty()) {
    auto frames = queue_.pop(flush);
    if (frames.empty()) {
      if (flush) makeScenes(std::nullopt);
      if (ready_.empty()) return std::nullopt;
      break;
    }
    mergeScans(frames);
    processInstant(std::move(frames));
  }
  Scene scene = std::move(ready_.front());
  ready_.pop_front();
  return scene;
}

EgoState Pipeline::egoAt(Stamp stamp) {
  // Tracks live in the world: in another one they are nowhere.
  if (std::exchange(frame_epoch_, ego_.frameEpoch()) != ego_.frameEpoch() && last_instant_) {
    events_.add(stamp, event_kind::kEgoGap, "the world's frame is known now: tracks start anew");
    restartTracks();
  }
  if (ego_.empty()) {
    if (!parked_said_)
      events_.warn(stamp, event_kind::kEgoGap,
                   "no ego pose yet: the vehicle is taken to stand still");
    parked_said_ = true;
    return EgoPose::parked(stamp, setup_.ego.minimum);
  }
  if (const auto state = ego_.at(stamp)) {
    ego_gap_ = false;
    return *state;
  }
  EgoState state = ego_.at(ego_.latest()).value_or(EgoPose::parked(stamp, setup_.ego.minimum));
  const double gap = stamp - state.stamp;
  if (!ego_gap_) {
    events_.warn(stamp, event_kind::kEgoGap,
                 fmt::format("no ego pose for {:.3f} s: extrapolated", gap));
  }
  ego_gap_ = true;
  state.T_world_ego.translation().head<2>() += gap * state.velocity;
  state.uncertainty.sigma_xy += kEgoGapDrift * std::abs(gap);
  state.stamp = stamp;
  return state;
}

// A vehicle that is only taken to stand may be anywhere after a while: what is seen now would be
// paired with what stood there before, and look as if it had run.
void Pipeline::restartAfterBlindGap(Stamp stamp) {
  if (!ego_.empty() || !last_instant_) return;
  const double gap = stamp - *last_instant_;
  if (gap <= setup_.ego.blind_gap) return;
  events_.warn(stamp, event_kind::kEgoGap,
               fmt::format("nothing seen for {:.3f} s, and nothing tells how the vehicle moved: "
                           "tracks start anew",
                           gap));
  restartTracks();
}

void Pipeline::restartTracks() {
  makeScenes(std::nullopt);
  tracker_.reset();
  if (observer_) observer_->onRestart();
  occlusion_.reset();
}

std::int64_t Pipeline::frameNumberAt(Stamp stamp) const {
  for (auto it = frame_numbers_.rbegin(); it != frame_numbers_.rend(); ++it) {
    if (std::abs(stamp - it->first) <= kSameInstant) return it->second;
  }
  return -1;
}

void Pipeline::processInstant(std::vector<SensorFrame> frames) {
  if (frames.empty()) return;
  const Stamp stamp = frames.front().stamp;
  emitUntil(stamp);
  restartAfterBlindGap(stamp);
  const EgoState ego = egoAt(stamp);
  const std::int64_t number = frameNumberAt(stamp);
  bool output = false;
  for (auto& frame : frames) {
    const auto index = static_cast<std::size_t>(sensorIndex(frame.sensor));
    frame.ego = ego;
    frame.frame = number;
    if (const auto scan = measure(frame, index)) update(*scan);
    SensorState& state = states_[index];
    if (state.lost) events_.add(stamp, event_kind::kSensorBack, frame.sensor + " is back");
    state.lost = false;
    state.last = stamp;
    output = output || index == output_sensor_;
  }
  watchSensors(stamp);
  last_instant_ = stamp;
  if (setup_.run.output_lag > 0) makeScenes(stamp);
  if (setup_.run.output_rate > 0) {
    if (!next_output_) next_output_ = stamp;
  } else if (output) {
    emit(ego, number);
  }
}

std::optional<MeasurementScan> Pipeline::measure(SensorFrame& frame, std::size_t sensor) {
  SensorState& state = states_[sensor];
  if (state.ground && std::holds_alternative<LidarCloud>(frame.data)) {
    const auto scope = timing_.stage("ground");
    ground_ = state.ground->update(frame);
  }
  frame.ground = ground_;
  if (state.weather) {
    const auto scope = timing_.stage("weather");
    state.weather->apply(frame);
  }
  const auto scope = timing_.stage(setup_.sensors[sensor].params.kind.c_str());
  MeasurementScan scan = setup_.sensors[sensor].front_end->extract(frame);
  if (scan.occlusion) {
    occlusion_ = scan.occlusion;
    occlusion_stamp_ = frame.stamp;
  } else if (occlusion_ && std::abs(frame.stamp - occlusion_stamp_) <= kOcclusionMapAge) {
    scan.occlusion = occlusion_;
  }
  ++state.record.frames;
  state.record.measurements += scan.measurements.size();
  state.record.dropped_measurements += scan.dropped;
  state.record.dropped_points += scan.dropped_points;
  if (scan.dropped_points > 0 && !state.points_reported) {
    events_.warn(frame.stamp, event_kind::kDroppedPoints,
                 fmt::format("{}: {} returns of a scan without a range or beyond max_points",
                             frame.sensor, scan.dropped_points));
    state.points_reported = true;
  }
  return scan;
}

void Pipeline::update(const MeasurementScan& scan) {
  if (observer_) observer_->onScan(scan);
  const auto scope = timing_.stage("filter");
  tracker_.process(scan);
}

void Pipeline::watchSensors(Stamp now) {
  for (auto& s : states_) {
    if (s.lost || !s.last || now - *s.last <= setup_.run.sensor_timeout) continue;
    s.lost = true;
    events_.warn(now, event_kind::kSensorLost,
                 fmt::format("{}: nothing for {:.3f} s", s.record.label, now - *s.last));
  }
}

void Pipeline::emit(const EgoState& ego, std::int64_t frame) {
  if (observer_) observer_->onScene(ego, frame);
  pending_outputs_.emplace_back(ego, frame);
  makeScenes(ego.stamp);
}

// Those whose lag is over; without `now` all, as no more is going to be seen.
void Pipeline::makeScenes(std::optional<Stamp> now) {
  const auto scope = timing_.stage("scene");
  while (!pending_outputs_.empty() &&
         (!now || *now - pending_outputs_.front().first.stamp >= setup_.run.output_lag)) {
    const auto& [ego, frame] = pending_outputs_.front();
    ready_.push_back(scenes_.make(tracker_.mapHypothesis(), ego, frame));
    pending_outputs_.pop_front();
  }
}

void Pipeline::emitUntil(Stamp stamp) {
  while (next_output_ && last_instant_ && *next_output_ < stamp) {
    emit(egoAt(*next_output_), frameNumberAt(*next_output_));
    next_output_ = *next_output_ + 1 / setup_.run.output_rate;
  }
}

void Pipeline::finish() {
  for (std::size_t i = 0; i < states_.size(); ++i) {
    if (setup_.sensors[i].active && states_[i].record.frames == 0) {
      events_.warn(
          std::nullopt, event_kind::kSensorMissing,
          setup_.sensors[i].label + ": in use by the configuration, but nothing of it in the log");
    }
  }
  for (const auto& [label, frames] : ignored_) {
    events_.add(std::nullopt, event_kind::kSensorIgnored,
                label + ": in the log, but not in the configuration", {{"frames", frames}});
  }
}

std::vector<SensorRecord> Pipeline::sensorRecords() const {
  std::vector<SensorRecord> records;
  for (std::size_t i = 0; i < states_.size(); ++i) {
    if (setup_.sensors[i].active) records.push_back(states_[i].record);
  }
  return records;
}

}  // namespace perception
