#include "libperception/pictures/pages/ReportData.h"

#include <algorithm>
#include <map>
#include <utility>

#include "gui-offscreen/html/RunWeather.h"
#include "libperception/evaluation/metrics/Evaluation.h"
#include "libperception/pictures/RunScenes.h"
#include "libperception/pictures/pages/ResultFiles.h"
#include "libperception/pipeline/output/Progress.h"

namespace perception {

RunErrors errorsOf(const TrackedRun& run, const GroundTruth& truth) {
  std::map<double, std::size_t> scenes;
  for (std::size_t k = 0; k < run.scenes.size(); ++k)
    scenes[run.scenes[k].stamp - run.first_stamp] = k;
  RunErrors errors(run.scenes.size());
  const Evaluation evaluation = evaluate(run, truth, {});
  for (const TruthSample& sample : evaluation.samples) {
    const auto& match = sample.matched(Pairing::kOneToOne);
    if (!match) continue;
    TruthErrors& e = errors[scenes.at(sample.t)][match->id];
    e.truth = sample.id;
    e.position = match->distance;
    e.speed = match->speed_error;
    e.heading = match->heading_error;
    e.right_class = match->class_id == sample.class_id;
  }
  return errors;
}

namespace {

/// Collects a run part by part.
class RunCollector {
 public:
  RunCollector(const RunOutline& run, ReportSources& sources, CollectedRun& to)
      : run_(run), sources_(sources), window_(*sources.window), to_(to), reader_(run.dir) {
    window_ = {run.dir, run.first_stamp, run.class_names, {}};
  }

  void collect() {
    ObjectLives lives(run_);
    Progress progress("collecting", run_.stamps.size());
    for (std::size_t from = 0; from < run_.stamps.size();) {
      std::vector<Scene> scenes = reader_.next(RunParts::kScenes);
      if (scenes.empty()) break;  // the run changed meanwhile
      stopIfAsked();
      for (const Scene& scene : scenes) lives.add(scene);
      collect(from, std::move(scenes));
      from += RunParts::kScenes;
      progress.update(from, from);
    }
    reader_.next();  // finds rows too many
    to_.lives = lives.list();
  }

 private:
  double timeOf(const Scene& scene) const { return scene.stamp - run_.first_stamp; }

  // The scenes from number `from` on.
  void collect(std::size_t from, std::vector<Scene> scenes) {
    const std::size_t count = scenes.size();
    const GroundTruth* truth = nullptr;
    RunErrors errors;
    if (sources_.truth) {
      truth = &sources_.truth->around({timeOf(scenes.front()), timeOf(scenes.back()),
                                       scenes.front().frame, scenes.back().frame});
      errors = errorsOf({run_.dir, run_.first_stamp, run_.class_names, scenes}, *truth);
    }
    if (sources_.sensors) lookBack(scenes);
    to_.parts->begin(scenes, errors);
    if (!sources_.sensors && !truth) return;
    for (std::size_t i = 0; i < count; ++i) {
      SceneView view;
      view.scene = std::move(scenes[i]);
      view.t = timeOf(view.scene);
      if (truth) addTruth(*truth, view);
      if (sources_.sensors) {
        sources_.sensors->advanceTo(view.scene.stamp);
        if (to_.parts->sensed(from + i)) sources_.sensors->fill(view);
      }
      to_.parts->add(from + i, std::move(view));
    }
  }

  // The window ends with these scenes and begins before all that count for the first of them.
  void lookBack(const std::vector<Scene>& scenes) {
    const Stamp first = scenes.front().stamp + -sources_.sensors->past();
    auto& kept = window_.scenes;
    auto from = std::upper_bound(kept.begin(), kept.end(), first,
                                 [](Stamp t, const Scene& s) { return t < s.stamp; });
    if (from != kept.begin()) --from;
    kept.erase(kept.begin(), from);
    for (const Scene& scene : scenes) {
      Scene& pose = kept.emplace_back();
      pose.stamp = scene.stamp;
      pose.ego = scene.ego;
    }
  }

  const RunOutline& run_;
  ReportSources& sources_;
  TrackedRun& window_;
  CollectedRun& to_;
  TrackedRunReader reader_;
};

}  // namespace

CollectedRun collectRun(const RunOutline& run, const RunRecord& record, ReportSources& sources,
                        const std::string& prefix, const std::string& output) {
  CollectedRun collected;
  collected.parts = std::make_unique<RunParts>(
      run, record, output,
      RunParts::Options{prefix, sources.truth.has_value(), sources.origin, RunData::Budget()});
  if (!sources.events.empty()) {
    eachLineOf(sources.events, [&](const nlohmann::json& event) {
      if (event.is_object() && event.value("kind", "").rfind("phantoms_", 0) == 0)
        collected.phantoms.push_back(event);
      collected.parts->addEvent(event);
    });
  }
  collected.parts->setWeather(weatherOf(run.dir));
  RunCollector(run, sources, collected).collect();
  return collected;
}

}  // namespace perception
