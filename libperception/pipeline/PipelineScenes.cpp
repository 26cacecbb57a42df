// How a Pipeline makes its scenes, at once or while the grid lags.
#include <unordered_set>
#include <utility>

#include "libperception/core/system/Parallel.h"
#include "libperception/pipeline/Pipeline.h"

namespace perception {

void Pipeline::letGridLag() {
  grid_lags_ = safety_ && canRunBoth() && setup_.run.output_lag <= 0 && setup_.run.output_rate <= 0;
}

void Pipeline::addOutput(const EgoState& ego, std::int64_t frame) {
  OutputSchedule::Instant instant{ego, frame, {}};
  if (grid_lags_) {
    if (late_) catchUp();
    late_ = std::move(instant);
    grid_work_.add([this] { findPath(*late_); });
  } else {
    findPath(instant);
    putOutput(std::move(instant));
  }
}

void Pipeline::findPath(OutputSchedule::Instant& instant) {
  if (!safety_) return;
  const auto scope = timing_.stage("grid");
  instant.path = safety_->pathAhead(instant.ego);
}

void Pipeline::putOutput(OutputSchedule::Instant instant) {
  for (PipelineObserver* o : observers_)
    o->onPath(instant.path), o->onScene(instant.ego, instant.frame);
  const Stamp stamp = instant.ego.stamp;
  outputs_.push(std::move(instant));
  makeScenes(stamp);
}

/// Waits for the grid, and makes the scene that is late.
void Pipeline::catchUp() {
  grid_work_.wait();
  if (late_) putOutput(*std::exchange(late_, std::nullopt));
}

/// Makes the scenes whose lag has passed; without `now` (end of log) all.
void Pipeline::makeScenes(std::optional<Stamp> now) {
  const auto scope = timing_.stage("scene");
  while (const auto instant = outputs_.takeDue(now)) {
    ready_.push_back(scenes_.make(tracker_.mapHypothesis(), instant->ego, instant->frame));
    if (instant->path.known) ready_.back().path = safety_->advise(instant->path, ready_.back());
    for (PipelineObserver* o : observers_) o->onOutput(ready_.back());
  }
}

std::set<std::uint64_t> Pipeline::livingObjects() {
  // What a late scene will show is in the filter still.
  std::unordered_set<std::uint64_t> tracks;
  for (const auto& track : tracker_.mapHypothesis().tracks) tracks.insert(track->id);
  for (const auto& particle : tracker_.m_particles)
    for (const auto& track : particle.d->tracks) tracks.insert(track->id);
  std::set<std::uint64_t> ids = scenes_.keepOnly(tracks);
  for (const Scene& scene : ready_)
    for (const SceneObject& object : scene.objects) ids.insert(object.id);
  return ids;
}

}  // namespace perception
