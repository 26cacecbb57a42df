#include "libperception/pipeline/Pipeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "libperception/core/system/Parallel.h"
#include "libperception/filter/predict/Prediction.h"
#include "libperception/pipeline/input/MergedScanners.h"
#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/sensors/observations/Conversions.h"

namespace perception {
namespace {

/// [s] longest gap in a recording, ten years; a larger one is a clock that was set. Assumed.
constexpr double kLongestGap = 10 * 365.25 * 86400;
/// [m] a sensor beyond is not on the vehicle; assumed, generous for roadside sensors.
constexpr double kFarthestMount = 1000;

}  // namespace

Pipeline::Pipeline(PipelineSetup setup, EventLog& events, RunTiming& timing)
    : setup_(std::move(setup)),
      events_(events),
      timing_(timing),
      tracker_(setup_.model, setup_.particles.toMrpt(), setup_.run.seed),
      scenes_(setup_.model, setup_.scene),
      ego_(setup_.ego, events),
      queue_({setup_.run.reorder_window, 70}),
      watch_(setup_.sensors, setup_.run.sensor_timeout, events),
      inputs_(events),
      health_(setup_.sensors, events),
      weather_(events),
      conditions_(setup_.sensors, weather_),
      wakes_(setup_.sensors, setup_.model.classes),
      ledger_(events),
      scan_maker_(setup_, timing, weather_, ledger_),
      outputs_(setup_.run, setup_.sensors) {
  if (setup_.grid.enabled) safety_.emplace(setup_.grid, setup_.stop, setup_.weather.trust);
}

void Pipeline::add(const mrpt::obs::CObservation& observation, mrpt::obs::CObservation* own) {
  const auto stamp = toStamp(observation.timestamp);
  if (stamp) addTime(*stamp);
  if (const auto number = frameNumber(observation)) {
    if (stamp) frame_numbers_.add(*stamp, *number);
  } else if (isImage(observation)) {
    return;  // no front end reads images: their boxes come as detections
  } else if (isSensorData(observation)) {
    addFrame(observation, own);
  } else {
    ego_.add(observation);
  }
}

void Pipeline::addTime(Stamp stamp) {
  if (!first_stamp_) first_stamp_ = stamp;
  const double step = last_stamp_.ns != 0 ? stamp - last_stamp_ : 0;
  if (step < -setup_.run.clock_jump)
    startEpoch(stamp, fmt::format("the clock went back by {:.3f} s", -step));
  if (step > setup_.run.clock_jump) passGap(stamp, step);
  last_stamp_ = std::max(last_stamp_, stamp);
  queue_.advance(stamp);
}

void Pipeline::passGap(Stamp stamp, double gap) {
  if (gap > kLongestGap)
    return startEpoch(stamp, fmt::format("the clock went ahead by {:.3f} s", gap));
  // Before the first pose after the gap, which would remove the poses of these frames from the
  // buffer.
  while (processNext(true)) continue;
  const bool all_end = gap > longestLife(setup_.model.params);
  events_.add(stamp, event_kind::kClockJump,
              fmt::format("nothing for {:.3f} s{}", gap, all_end ? ": tracks start anew" : ""));
  watch_.restart(stamp);  // no sensor is lost where nothing comes from any
  if (!all_end) return;
  restartTracks();
  outputs_.restart();
}

void Pipeline::startEpoch(Stamp stamp, const std::string& why) {
  while (processNext(true)) continue;
  events_.warn(stamp, event_kind::kClockJump, why + ": tracks start anew");
  restartTracks();
  ego_.clear();
  queue_.clear();
  frame_numbers_.clear();
  outputs_.restart();
  watch_.restart(stamp);
  last_stamp_ = stamp;
}

void Pipeline::addFrame(const mrpt::obs::CObservation& observation, mrpt::obs::CObservation* own) {
  const auto sensor = setup_.sensorOf(observation.sensorLabel);
  if (!sensor) return watch_.countIgnored(observation.sensorLabel);
  if (!setup_.sensors[*sensor].used()) return;
  const auto scope = timing_.stage("decode");
  DecodeCounts counts;
  auto frame = own != nullptr ? frameFromObservation(std::move(*own), counts)
                              : frameFromObservation(observation, &counts);
  watch_.countDroppedPoints(*sensor, counts.dropped());
  if (!frame) {
    watch_.addDroppedFrame(*sensor, toStamp(observation.timestamp), event_kind::kDroppedFrame,
                           "an observation that cannot be used", true);
    return;
  }
  if (const auto& pose = setup_.sensors[*sensor].params.pose) frame->T_ego_sensor = *pose;
  const Stamp stamp = frame->stamp;
  const Pose3& mount = frame->T_ego_sensor;
  if (!mount.matrix().allFinite() || mount.translation().norm() > kFarthestMount) {
    watch_.addDroppedFrame(
        *sensor, stamp, event_kind::kDroppedFrame,
        fmt::format("its sensor is more than {} m from the vehicle's origin", kFarthestMount),
        true);
    return;
  }
  switch (queue_.push(std::move(*frame))) {
    case FrameQueue::Verdict::kTaken:
      break;
    case FrameQueue::Verdict::kDuplicate:
      watch_.addDroppedFrame(*sensor, stamp, event_kind::kDroppedFrame,
                             "a second frame of the same instant", false);
      break;
    case FrameQueue::Verdict::kTooLate:
      watch_.addDroppedFrame(*sensor, stamp, event_kind::kOutOfOrder,
                             "older than the reorder window", true);
      break;
  }
}

void Pipeline::finish() {
  catchUp();
  watch_.finish();
  ledger_.finish();
  const auto lines = learned();
  if (!lines.empty())
    events_.add(std::nullopt, event_kind::kLearned, fmt::format("{}", fmt::join(lines, "\n")));
}

std::vector<std::string> Pipeline::learned() const {
  auto lines = scan_maker_.learned();
  for (auto& line : conditions_.learned()) lines.push_back(std::move(line));
  return lines;
}

std::optional<Scene> Pipeline::next(bool flush) {
  const std::uint64_t before = made_;
  while (ready_.empty() && made_ == before && processNext(flush)) continue;
  if (ready_.empty() && made_ == before && flush) catchUp(), makeScenes(std::nullopt);
  if (ready_.empty()) return std::nullopt;
  Scene scene = std::move(ready_.front());
  ready_.pop_front();
  return scene;
}

/// Processes the frames of the oldest stamp once its window has passed; with `flush` at once. False
/// if there are none.
bool Pipeline::processNext(bool flush) {
  auto popped = queue_.pop(flush);
  if (popped.empty() && !(flush && !waiting_.empty())) return false;
  if (!popped.empty()) {
    auto frames = mergeScanners(
        setup_.sensors, std::move(popped), queue_,
        [this](std::size_t sensor, const SensorFrame& part) { health_.addPart(sensor, part); });
    if (frames.empty()) return true;
    addToOdometry(frames);
    const Stamp stamp = frames.front().stamp;
    waiting_.push_back(std::move(frames));
    if (ego_.isStarting(stamp)) return true;
  }
  for (; !waiting_.empty(); waiting_.pop_front()) processFrames(std::move(waiting_.front()));
  return true;
}

void Pipeline::processFrames(std::vector<SensorFrame> frames) {
  const Stamp stamp = frames.front().stamp;
  while (const auto earlier = outputs_.takeBefore(stamp))
    addOutput(egoAt(*earlier), frame_numbers_.at(*earlier));
  if (ego_.isBlindGap(stamp)) restartTracks();
  const EgoState ego = egoAt(stamp);
  const std::int64_t number = frame_numbers_.at(stamp);
  for (auto& frame : frames) {
    const std::size_t sensor = *setup_.sensorOf(frame.sensor);
    frame.ego = ego;
    frame.frame = number;
    processFrame(sensor, frame);
    outputs_.addFrame(sensor, stamp);
  }
  watch_.check(stamp);
  ego_.setSeen(stamp);
  if (setup_.run.output_lag > 0) makeScenes(stamp);
  if (isOutput(stamp)) addOutput(ego, number);
}

/// Scans of the first lidar in use, or of one that gives the ground; all radars in use.
void Pipeline::addToOdometry(const std::vector<SensorFrame>& frames) {
  if (setup_.ego.source == EgoPoseParams::Source::kRadar) {
    const auto scope = timing_.stage("odometry");
    std::vector<const SensorFrame*> radars;
    for (const auto& frame : frames)
      if (setup_.sensors[*setup_.sensorOf(frame.sensor)].isRadarInUse()) radars.push_back(&frame);
    ego_.addRadars(radars);
  }
  if (setup_.ego.source != EgoPoseParams::Source::kLidar) return;
  const auto lidar = std::find_if(setup_.sensors.begin(), setup_.sensors.end(),
                                  [](const auto& s) { return s.isLidarInUse(); });
  if (lidar == setup_.sensors.end()) return;
  const auto scope = timing_.stage("odometry");
  for (const auto& frame : frames)
    if (setup_.sensorOf(frame.sensor) == lidar - setup_.sensors.begin()) ego_.addScan(frame);
}

bool Pipeline::isOutput(Stamp stamp) {
  const std::size_t before = outputs_.sensor();
  const bool output = outputs_.isOutput(stamp);
  if (const std::size_t now = outputs_.sensor(); now != before) {
    events_.add(stamp, event_kind::kOutputSensor,
                fmt::format("scenes at the scans of {} in place of {}", setup_.sensors[now].label,
                            setup_.sensors[before].label));
  }
  return output;
}

void Pipeline::processFrame(std::size_t sensor, SensorFrame& frame) {
  const Stamp stamp = frame.stamp;
  scan_maker_.addGround(sensor, frame);
  if (setup_.sensors[sensor].active) {
    health_.addFrame(sensor, frame, weather_.fog());
    inputs_.apply(frame);
    if (setup_.sensors[sensor].params.modality == Modality::kLidar) {
      frame.causes.wakes = wakes_.at(stamp);
      frame.causes.spray = wakes_.spray(sensor, stamp);
    }
    MeasurementScan scan = scan_maker_.measure(sensor, frame);
    const double share = conditions_.apply(sensor, scan, health_.count(sensor));
    wakes_.apply(sensor, scan, conditions_.clutterRate(sensor));
    watch_.addFrame(sensor, stamp, &scan);
    for (PipelineObserver* o : observers_) o->onFrame(frame), o->onScan(scan);
    const auto returns = std::exchange(scan.returns, nullptr);
    if (returns != nullptr && !grid_lags_) {
      runBoth([&] { filter(sensor, scan, share); }, [&] { addToGrid(frame, *returns); });
    } else {
      if (returns != nullptr) addToGridLater(std::move(frame), returns);
      filter(sensor, scan, share);
    }
  } else {
    watch_.addFrame(sensor, stamp, nullptr);
  }
  watch_.setSeen(sensor, stamp);
}

void Pipeline::filter(std::size_t sensor, MeasurementScan& scan, double share) {
  const auto scope = timing_.stage("filter");
  const std::uint64_t index = tracker_.scans();
  innovations_.before(tracker_);
  if (!tracker_.process(scan)) return;
  innovations_.after(tracker_, scan, index);
  conditions_.add(sensor, scan, tracker_, index);
  wakes_.add(sensor, scan, tracker_.mapHypothesis());
  health_.addScan(sensor, scan, tracker_.mapHypothesis(), setup_.model, conditions_.clutter(sensor),
                  share);
}

void Pipeline::addToGrid(const SensorFrame& frame, const PlacedReturns& returns) {
  if (!safety_) return;
  const auto scope = timing_.stage("grid");
  safety_->add(frame, returns);
}

EgoState Pipeline::egoAt(Stamp stamp) {
  if (ego_.changedFrame(stamp)) restartTracks();
  return ego_.at(stamp);
}

void Pipeline::restartTracks() {
  catchUp();
  makeScenes(std::nullopt);
  tracker_.reset();
  health_.restart();
  conditions_.restart();
  wakes_.restart();
  for (PipelineObserver* o : observers_) o->onRestart();
  scan_maker_.restart();
  if (safety_) safety_->restart();
}

}  // namespace perception
