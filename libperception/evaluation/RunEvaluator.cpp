#include "libperception/evaluation/RunEvaluator.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/scene/files/MeasurementRun.h"
#include "libperception/scene/files/RunRecord.h"
#include "libperception/scene/files/TrackedRun.h"

namespace perception {

namespace fs = std::filesystem;

RunEvaluator::RunEvaluator(RunEvaluatorOptions options, Listener warn, Listener note)
    : options_(std::move(options)), warn_(std::move(warn)), note_(std::move(note)) {
  if (!options_.truth_poses.empty())
    options_.params.alignment.truth_poses =
        std::make_shared<TrackedRun>(readTrackedRun(options_.truth_poses));
}

const GroundTruth& RunEvaluator::truth(const std::string& path) {
  const auto known = truths_.find(path);
  return known != truths_.end() ? known->second
                                : truths_.emplace(path, readGroundTruth(path)).first->second;
}

void RunEvaluator::evaluateFrontEnds(const RunEntry& entry, const GroundTruth& truth,
                                     EvaluatedRun& run) const {
  if (options_.front_ends.empty()) return;
  if (!fs::exists(entry.dir + "/measurements.csv")) {
    throw DataError(entry.dir + "/measurements.csv: is not there: track with --measurements",
                    ExitCode::kNoInput);
  }
  FrontEndOptions options;
  options.selection = options_.params.selection;
  options.alignment = options_.params.alignment;
  const std::string record = entry.dir + "/done.json";
  options.surroundings =
      options_.surroundings || (fs::exists(record) && readRunRecord(record).simulated);
  const MeasurementRun measurements = readMeasurementRun(entry.dir);
  for (const std::string& pattern : options_.front_ends)
    run.front_ends.push_back(evaluateFrontEnd(measurements, pattern, truth, options));
}

EvaluatedRun RunEvaluator::evaluated(const RunEntry& entry, const std::string& name) {
  const GroundTruth& known = truth(entry.truth);
  const TrackedRun run = readTrackedRun(entry.dir);
  if (const auto& poses = options_.params.alignment.truth_poses;
      poses && poses->first_stamp != run.first_stamp)
    throw DataError(
        fmt::format("--truth-poses {}: not a run of the log of {}: the first stamps "
                    "differ",
                    options_.truth_poses, entry.dir));
  EvaluatedRun evaluated{name, entry.dir, evaluate(run, known, options_.params)};
  if (options_.nuscenes)
    evaluated.benchmark = trackingBenchmark(run, known, options_.params.alignment);
  if (!options_.reference.empty())
    evaluated.count_difference = countDifference(run, readTrackedRun(options_.reference));
  if (const std::string file = entry.dir + "/done.json"; fs::exists(file)) {
    const RunRecord record = readRunRecord(file);
    evaluated.weather = record.weather;
    if (!options_.any_truth) requireTruthOf(record, entry.truth);
  }
  evaluateFrontEnds(entry, known, evaluated);
  tellOfGaps(evaluated, entry.truth);
  return evaluated;
}

void RunEvaluator::tellOfGaps(const EvaluatedRun& run, const std::string& truth) const {
  const TruthAlignment& alignment = run.evaluation.alignment;
  if (run.evaluation.instants.empty()) {
    const std::string fault =
        fmt::format("{}: no scene has a truth in {} (other log, or times more than {:g} s apart)",
                    run.dir, truth, options_.params.alignment.time_limit);
    if (!options_.any_truth) throw DataError(fault + "; with --any-truth every figure is n/a");
    warn_(fault + ": every figure is n/a");
  } else if (run.evaluation.samples.empty()) {
    warn_(fmt::format("{}: no truth object counts: tracking figures are n/a", run.dir));
  }
  if (run.evaluation.instants.empty()) return;
  const auto count = [&](std::size_t number, const char* what) {
    if (number > 0) note_(fmt::format("{}: {} {} are in no figure", run.dir, number, what));
  };
  count(alignment.scenes_without_truth, "scenes without truth");
  count(alignment.truth_without_scene, "truth instants without scene");
}

}  // namespace perception
