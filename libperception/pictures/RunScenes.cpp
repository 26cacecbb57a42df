#include "libperception/pictures/RunScenes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libperception/core/Error.h"

namespace perception {
namespace {

constexpr double kTrail = 2;            // [s]
constexpr double kNearestTruth = 0.06;  // [s] half the period of 10 Hz, and rounding
constexpr double kUnknownSize = 0.3;    // [m] of truth without a size
constexpr double kTruthAround = 1;      // [s] in which the truth of a scene nearly always is

using TruthInstants = std::vector<GroundTruth::Instant>;

// By frame number if both have one, else the nearest in time.
const GroundTruth::Instant* truthOf(const SceneView& view, TruthInstants::const_iterator from,
                                    TruthInstants::const_iterator to) {
  const GroundTruth::Instant* best = nullptr;
  for (; from != to; ++from) {
    if (from->frame >= 0 && view.scene.frame >= 0) {
      if (from->frame == view.scene.frame) best = &*from;
    } else if (std::abs(from->t - view.t) <= (best ? std::abs(best->t - view.t) : kNearestTruth)) {
      best = &*from;
    }
  }
  return best;
}

}  // namespace

void addTruth(const GroundTruth& truth, SceneView& result) {
  result.has_truth = true;
  const TruthInstants& all = truth.instants;
  const auto after = [&](double t) {
    return std::lower_bound(all.begin(), all.end(), t,
                            [](const GroundTruth::Instant& i, double time) { return i.t < time; });
  };
  const auto* best =
      truthOf(result, after(result.t - kTruthAround), after(result.t + kTruthAround));
  // Farther away is only what has the same frame number, by a clock that is shifted.
  if (!best && result.scene.frame >= 0) best = truthOf(result, all.begin(), all.end());
  if (!best) return;
  for (const TruthObject& object : best->objects) {
    if (!object.position.allFinite() || object.ignore) continue;
    TruthObject& drawn = result.truth.emplace_back(object);
    // Unknown sizes of the truth are drawn small: radar labels have no height, points no size.
    for (double* size : {&drawn.length, &drawn.width, &drawn.height}) {
      if (!(*size > 0)) *size = kUnknownSize;
    }
    if (!std::isfinite(drawn.yaw)) drawn.yaw = 0;
  }
}

std::size_t nearestScene(const TrackedRun& run, Stamp stamp) {
  const auto off = [&](std::size_t i) { return std::abs(run.scenes[i].stamp - stamp); };
  std::size_t best = 0;
  for (std::size_t i = 1; i < run.scenes.size(); ++i) {
    if (off(i) < off(best)) best = i;
  }
  return best;
}

std::size_t sceneAt(const TrackedRun& run, double t) {
  const std::size_t best = nearestScene(run, run.first_stamp + t);
  if (std::abs(run.scenes[best].stamp - run.first_stamp - t) > kNearestScene) {
    throw Error(ExitCode::kUsage,
                fmt::format("--time {:g}: {} has scenes from {:.2f} to {:.2f} s, none near", t,
                            run.dir, run.scenes.front().stamp - run.first_stamp,
                            run.scenes.back().stamp - run.first_stamp));
  }
  return best;
}

std::size_t sceneOfFrame(const TrackedRun& run, std::int64_t number) {
  for (std::size_t i = 0; i < run.scenes.size(); ++i) {
    if (run.scenes[i].frame == number) return i;
  }
  throw Error(ExitCode::kUsage,
              fmt::format("--frame {}: {} has no scene of it (first {}, last {})", number, run.dir,
                          run.scenes.front().frame, run.scenes.back().frame));
}

std::vector<std::size_t> scenesBetween(const TrackedRun& run, double from, double to) {
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < run.scenes.size(); ++i) {
    const double t = run.scenes[i].stamp - run.first_stamp;
    if (t >= from && t <= to) chosen.push_back(i);
  }
  if (chosen.empty()) throw Error(ExitCode::kUsage, "--from, --to: no scene between them");
  return chosen;
}

std::vector<std::size_t> scenesEvery(const TrackedRun& run, double every) {
  std::vector<std::size_t> chosen;
  Stamp due = run.scenes.front().stamp;
  for (std::size_t i = 0; i < run.scenes.size(); ++i) {
    if (run.scenes[i].stamp < due) continue;
    chosen.push_back(i);
    while (every > 0 && due <= run.scenes[i].stamp) due = due + every;
  }
  return chosen;
}

std::vector<std::size_t> spread(const std::vector<std::size_t>& all, std::size_t count) {
  if (all.size() <= count) return all;
  if (count == 1) return {all[all.size() / 2]};
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < count; ++i) chosen.push_back(all[i * (all.size() - 1) / (count - 1)]);
  return chosen;
}

SceneView viewOfScene(const TrackedRun& run, std::size_t index, const GroundTruth* truth) {
  SceneView view;
  view.scene = run.scenes[index];
  view.t = view.scene.stamp - run.first_stamp;
  view.class_names = run.class_names;
  view.trails = trailsUpTo(run.scenes, index, kTrail);
  if (truth) addTruth(*truth, view);
  return view;
}

}  // namespace perception
