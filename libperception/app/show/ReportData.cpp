#include "libperception/app/show/ReportData.h"

#include <map>

#include "gui-offscreen/html/RunParts.h"
#include "gui-offscreen/html/RunWeather.h"
#include "libperception/evaluation/metrics/Evaluation.h"
#include "libperception/pictures/RunScenes.h"
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

std::string reportData(const TrackedRun& run, const RunRecord& record, ReportSources& sources,
                       const std::string& prefix) {
  std::optional<RunErrors> errors;
  if (sources.truth) errors = errorsOf(run, *sources.truth);
  RunParts parts(run, record, errors ? &*errors : nullptr, sources.origin);
  if (!sources.events.is_null()) parts.setEvents(sources.events);
  parts.setWeather(weatherOf(run.dir));
  if (!sources.sensors && !sources.truth) return parts.html(prefix);
  Progress progress("collecting", run.scenes.size());
  for (std::size_t i = 0; i < run.scenes.size(); ++i) {
    stopIfAsked();
    SceneView view = viewOfScene(run, i, sources.truth ? &*sources.truth : nullptr);
    if (sources.sensors) {
      sources.sensors->advanceTo(run.scenes[i].stamp);
      if (parts.sensed(i)) sources.sensors->fill(view);
    }
    parts.add(i, std::move(view));
    progress.update(i + 1, i + 1);
  }
  return parts.html(prefix);
}

}  // namespace perception
