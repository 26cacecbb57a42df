// How a Pipeline makes its scenes, at once or while the grid lags.
#include <unordered_set>
#include <utility>

#include "libperception/core/system/Parallel.h"
#include "libperception/pipeline/Pipeline.h"

namespace perception {

/// Scans of lidars, and scenes, that the grid may be behind.
static constexpr std::size_t kMostLate = 2;

void Pipeline::letGridLag() { grid_lags_ = safety_ && canRunBoth() && setup_.run.output_lag <= 0; }

void Pipeline::addOutput(const EgoState& ego, std::int64_t frame) {
  OutputSchedule::Instant instant{ego, frame, {}};
  if (grid_lags_) {
    catchUp(kMostLate - 1);
    LateScene& late = late_.emplace_back(LateScene{std::move(instant), sceneOf(ego, frame), 0});
    late.work = grid_work_.add([this, &late] { findPath(late.instant); });
  } else {
    findPath(instant);
    // A stop cannot wait for what is known later.
    if (setup_.run.output_lag > 0 && instant.path.known) {
      const auto scope = timing_.stage("scene");
      instant.advice =
          safety_->advise(instant.path, scenes_.make(tracker_.mapHypothesis(), ego, frame));
    }
    putOutput(std::move(instant));
  }
}

void Pipeline::findPath(OutputSchedule::Instant& instant) {
  if (!safety_) return;
  const auto scope = timing_.stage("grid");
  instant.path = safety_->pathAhead(instant.ego);
}

void Pipeline::tellOf(const OutputSchedule::Instant& instant) {
  for (PipelineObserver* o : observers_)
    o->onPath(instant.path), o->onScene(instant.ego, instant.frame);
}

void Pipeline::putOutput(OutputSchedule::Instant instant) {
  tellOf(instant);
  const Stamp stamp = instant.ego.stamp;
  outputs_.push(std::move(instant));
  makeScenes(stamp);
}

/// Lets a scan of a lidar go into the grid behind this thread, once that is two scans behind at
/// most.
void Pipeline::addToGridLater(SensorFrame frame, std::shared_ptr<const PlacedReturns> returns) {
  if (scans_in_work_.size() == kMostLate) {
    grid_work_.wait(scans_in_work_.front());
    scans_in_work_.pop_front();
  }
  const auto kept = std::make_shared<const SensorFrame>(std::move(frame));
  scans_in_work_.push_back(
      grid_work_.add([this, kept, returns = std::move(returns)] { addToGrid(*kept, *returns); }));
}

/// Completes the scenes that are late but for the newest `most`; waits for their ways.
void Pipeline::catchUp(std::size_t most) {
  if (most == 0) grid_work_.wait();
  while (late_.size() > most) {
    grid_work_.wait(late_.front().work);
    LateScene late = std::move(late_.front());
    late_.pop_front();
    tellOf(late.instant);
    putScene(std::move(late.scene), late.instant);
  }
}

Scene Pipeline::sceneOf(const EgoState& ego, std::int64_t frame) {
  const auto scope = timing_.stage("scene");
  ++made_;
  return scenes_.make(tracker_.mapHypothesis(), ego, frame);
}

void Pipeline::putScene(Scene scene, const OutputSchedule::Instant& instant) {
  if (instant.advice) {
    scene.path = instant.advice;
  } else if (instant.path.known) {
    scene.path = safety_->advise(instant.path, scene);
  }
  for (PipelineObserver* o : observers_) o->onOutput(scene);
  ready_.push_back(std::move(scene));
}

/// Makes the scenes whose lag has passed; without `now` (end of log) all.
void Pipeline::makeScenes(std::optional<Stamp> now) {
  while (const auto instant = outputs_.takeDue(now))
    putScene(sceneOf(instant->ego, instant->frame), *instant);
}

std::set<std::uint64_t> Pipeline::livingObjects() {
  std::unordered_set<std::uint64_t> tracks;
  const auto addTracks = [&tracks](const Hypothesis& hypothesis) {
    for (const auto& track : hypothesis.tracks) tracks.insert(track->id);
    for (const EndedTrack& e : hypothesis.ended) tracks.insert(e.track->id);
  };
  addTracks(tracker_.mapHypothesis());
  for (const auto& particle : tracker_.m_particles) addTracks(*particle.d);
  std::set<std::uint64_t> ids = scenes_.keepOnly(tracks);
  const auto add = [&ids](const Scene& scene) {
    for (const SceneObject& object : scene.objects) ids.insert(object.id);
  };
  for (const Scene& scene : ready_) add(scene);
  for (const LateScene& late : late_) add(late.scene);
  return ids;
}

}  // namespace perception
