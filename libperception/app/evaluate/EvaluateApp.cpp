#include "libperception/app/evaluate/EvaluateApp.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "libperception/app/Programs.h"
#include "libperception/core/math/Angle.h"
#include "libperception/evaluation/plots/Plots.h"
#include "libperception/pipeline/output/FinishedRun.h"
#include "libperception/pipeline/output/OutputFolder.h"
#include "libperception/pipeline/output/Progress.h"
#include "libperception/scene/files/MeasurementRun.h"
#include "libperception/scene/files/OutputFile.h"
#include "libperception/scene/files/RunMark.h"
#include "libperception/scene/files/RunRecord.h"
#include "libperception/scene/files/TrackedRun.h"

namespace perception {

namespace fs = std::filesystem;

std::string EvaluateApp::description() const {
  return "Compares tracked runs with the truth of their log: table of Radecki et al., GOSPA, false "
         "objects, calibration, front ends, plots; several runs side by side or pooled.";
}

void EvaluateApp::declare(CLI::App& cli) {
  declareInputs(cli);
  addOutputOption(cli, false);
  cli.add_flag("--without-truth", without_truth,
               "figures that need no truth; with one, their rank correlation with the true errors");
  declareTruth(cli);
  declareFigures(cli);
}

void EvaluateApp::declareInputs(CLI::App& cli) {
  cli.add_option("-r,--run", runs,
                 "folder of a run of perception-track; several make one table. CONDITION=PATTERN: "
                 "all folders of that pattern, pooled as trials of one condition")
      ->type_name("DIR");
  cli.add_option(
         "-t,--truth", truth_file,
         "truth of the log, FILE.truth.csv; {log} stands for the name of a run's log, {run} "
         "for that of its folder")
      ->type_name("FILE");
  cli.add_option("--truth-poses", truth_poses,
                 "run of the same log with the poses that the truth was made with; use it if the "
                 "poses of -r are odometry. The truth is then taken relative to the vehicle")
      ->type_name("DIR");
  cli.add_option("--manifest", manifest,
                 "instead of -r and -t: CSV with the columns condition,run,truth; paths start at "
                 "its folder")
      ->type_name("FILE");
  cli.add_option("--front-end", front_ends,
                 "recall and precision of the sensor of this label, or of all that match a pattern "
                 "('RADAR_*'); for runs with --measurements")
      ->type_name("LABEL");
  cli.add_option("--paper", paper,
                 fmt::format("rows of Radecki et al. to list for comparison: {}",
                             fmt::join(paperTableNames(), ", ")))
      ->delimiter(',')
      ->type_name("NAME,...");
}

void EvaluateApp::declareTruth(CLI::App& cli) {
  cli.add_option("--range", params.selection.range, "truth counts up to this distance [m]")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 1e4));
  cli.add_option("--fov-deg", fov_deg, "whole angle ahead in which truth counts [deg]")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 360.0));
  cli.add_option("--complete-fov-deg", complete_fov_deg,
                 "whole angle ahead in which the truth knows every object (KITTI: 80); outputs "
                 "beyond it are never false [deg]")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 360.0));
  cli.add_option(
         "--min-points", params.selection.min_points,
         "truth counts if it has at least this many lidar returns; ignored where none are counted")
      ->capture_default_str()
      ->check(CLI::Range(0, 1000000));
  cli.add_option("--max-occluded", params.selection.max_occluded,
                 "truth counts up to this KITTI occlusion (0-3)")
      ->capture_default_str()
      ->check(CLI::Range(0, 3));
}

void EvaluateApp::declareFigures(CLI::App& cli) {
  cli.add_option("--tolerance", params.tolerance,
                 "greatest distance of the centers of truth and estimate [m]")
      ->capture_default_str()
      ->check(CLI::Range(0.01, 100.0));
  cli.add_option("--exclusion", params.exclusion,
                 "an output this near to any truth is not a false object [m]")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 100.0));
  cli.add_option("--cutoff", params.cutoff, "cut-off of GOSPA and OSPA [m]")
      ->capture_default_str()
      ->check(CLI::Range(0.01, 100.0));
  cli.add_option("--time-limit", params.alignment.time_limit,
                 "longest time between a scene and the truth that it is matched with [s]")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 10.0));
  cli.add_flag("--any-truth", any_truth,
               "accept the truth of another log, and a truth that no scene has");
  cli.add_flag(
      "--empty-frames", params.alignment.empty_frames,
      "a scene without a truth line holds no objects (default: nothing is known about it)");
  cli.add_option("--unnamed", params.unnamed, "classes that are neither true nor false to output")
      ->delimiter(',')
      ->type_name("NAME,...")
      ->capture_default_str();
  cli.add_option("--min-existence", params.min_existence,
                 "outputs below are left out of all figures but the existence calibration")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1.0));
  cli.add_flag(
      "--surroundings", surroundings,
      "the truth also holds poles and hedges, as that of simulated logs does: judge sizes");
  cli.add_option(
      "--sensors", params.sensors,
      "sensor set of the run for denominator B, as C+L+R; default: the sensors that hit an object");
  cli.add_flag("--nuscenes", nuscenes,
               "AMOTA and AMOTP by the definition of nuScenes' tracking benchmark, by class");
  cli.add_option("--reference", reference,
                 "run whose number of objects the others are compared with")
      ->type_name("DIR");
  cli.add_option("--max-plots", max_plots, "truth objects with a plot of their own, for each run")
      ->capture_default_str();
  cli.add_flag("!--no-plots", plots, "tables only");
}

std::string EvaluateApp::command() const {
  std::string text = name();
  for (const std::string& run : runs) text += " -r " + run;
  if (!truth_file.empty()) text += " -t " + truth_file;
  if (!truth_poses.empty()) text += " --truth-poses " + truth_poses;
  if (!manifest.empty()) text += " --manifest " + manifest;
  text += fmt::format(
      " --range {:g} --fov-deg {:g} --min-points {} --max-occluded {} --tolerance {:g} --exclusion "
      "{:g}",
      params.selection.range, fov_deg, params.selection.min_points, params.selection.max_occluded,
      params.tolerance, params.exclusion);
  text += fmt::format(" --cutoff {:g} --time-limit {:g} --unnamed {}", params.cutoff,
                      params.alignment.time_limit, fmt::join(params.unnamed, ","));
  text += fmt::format(" --complete-fov-deg {:g}", complete_fov_deg);
  if (params.alignment.empty_frames) text += " --empty-frames";
  if (!params.sensors.empty()) text += " --sensors " + params.sensors;
  if (params.min_existence > 0) text += fmt::format(" --min-existence {:g}", params.min_existence);
  if (surroundings) text += " --surroundings";
  if (nuscenes) text += " --nuscenes";
  for (const std::string& pattern : front_ends) text += " --front-end " + pattern;
  if (!paper.empty()) text += fmt::format(" --paper {}", fmt::join(paper, ","));
  if (!reference.empty()) text += " --reference " + reference;
  return text;
}

EvaluationReport EvaluateApp::emptyReport() const {
  EvaluationReport report;
  report.command = command();
  report.truth = manifest.empty() ? truth_file : manifest;
  report.reference = reference;
  report.options = params;
  report.paper = out_report.paper;
  return report;
}

const GroundTruth& EvaluateApp::truth(const std::string& path) {
  const auto known = truths_.find(path);
  return known != truths_.end() ? known->second
                                : truths_.emplace(path, readGroundTruth(path)).first->second;
}

void EvaluateApp::evaluateFrontEnds(const RunEntry& entry, const GroundTruth& truth,
                                    EvaluatedRun& run) {
  if (front_ends.empty()) return;
  if (!fs::exists(entry.dir + "/measurements.csv")) {
    throw DataError(entry.dir + "/measurements.csv: is not there: track with --measurements",
                    ExitCode::kNoInput);
  }
  FrontEndOptions options;
  options.selection = params.selection;
  options.alignment = params.alignment;
  const std::string record = entry.dir + "/done.json";
  options.surroundings = surroundings || (fs::exists(record) && readRunRecord(record).simulated);
  const MeasurementRun measurements = readMeasurementRun(entry.dir);
  for (const std::string& pattern : front_ends)
    run.front_ends.push_back(evaluateFrontEnd(measurements, pattern, truth, options));
}

EvaluatedRun EvaluateApp::evaluateEntry(const RunEntry& entry, const std::string& name) {
  stopIfAsked();
  const GroundTruth& known = truth(entry.truth);
  const TrackedRun run = readTrackedRun(entry.dir);
  if (const auto& poses = params.alignment.truth_poses;
      poses && poses->first_stamp != run.first_stamp)
    throw DataError(
        fmt::format("--truth-poses {}: not a run of the log of {}: the first stamps "
                    "differ",
                    truth_poses, entry.dir));
  EvaluatedRun evaluated{name, entry.dir, evaluate(run, known, params)};
  if (nuscenes) evaluated.benchmark = trackingBenchmark(run, known, params.alignment);
  if (!reference.empty())
    evaluated.count_difference = countDifference(run, readTrackedRun(reference));
  if (const std::string file = entry.dir + "/done.json"; fs::exists(file)) {
    const RunRecord record = readRunRecord(file);
    evaluated.weather = record.weather;
    evaluated.id = idOfRun(record);
    if (!any_truth) requireTruthOf(record, entry.truth);
  }
  evaluateFrontEnds(entry, known, evaluated);
  warnOfGaps(evaluated, entry.truth);
  return evaluated;
}

void EvaluateApp::evaluateRuns() {
  const std::vector<RunEntry> all = runEntries(runs, truth_file, manifest);
  std::vector<std::string> dirs, conditions;
  for (const RunEntry& entry : all) {
    dirs.push_back(entry.dir);
    conditions.push_back(entry.condition);
  }
  const std::vector<std::string> names = namesOfRuns(dirs);
  std::vector<EvaluatedRun> evaluated;
  for (std::size_t i = 0; i < all.size(); ++i) evaluated.push_back(evaluateEntry(all[i], names[i]));
  out_report.runs = pooledByCondition(conditions, std::move(evaluated));
}

void EvaluateApp::addPaperRows() {
  const std::vector<std::string> known = paperTableNames();
  for (const std::string& table : paper) {
    if (std::find(known.begin(), known.end(), table) == known.end()) {
      throw Error(ExitCode::kUsage,
                  fmt::format("--paper {}: there are: {}", table, fmt::join(known, ", ")));
    }
    for (const PaperTrackingRow& row : paperTrackingRows()) {
      if (row.table == table) out_report.paper.push_back(row);
    }
  }
}

void EvaluateApp::warnOfGaps(const EvaluatedRun& run, const std::string& truth) {
  const TruthAlignment& alignment = run.evaluation.alignment;
  if (run.evaluation.instants.empty()) {
    const std::string fault =
        fmt::format("{}: no scene has a truth in {} (other log, or times more than {:g} s apart)",
                    run.dir, truth, params.alignment.time_limit);
    if (!any_truth) throw DataError(fault + "; with --any-truth every figure is n/a");
    warn(fault + ": every figure is n/a");
  } else if (run.evaluation.samples.empty()) {
    warn(fmt::format("{}: no truth object counts: tracking figures are n/a", run.dir));
  }
  if (run.evaluation.instants.empty()) return;
  const auto count = [&](std::size_t number, const char* what) {
    if (number > 0) say(1, fmt::format("{}: {} {} are in no figure", run.dir, number, what));
  };
  count(alignment.scenes_without_truth, "scenes without truth");
  count(alignment.truth_without_scene, "truth instants without scene");
}

void EvaluateApp::write(EvaluationReport report, const std::string& dir) {
  OutputFolder folder(dir);
  const bool single = report.runs.size() == 1 && report.runs.front().trials.empty();
  if (plots && !report.runs.empty()) {
    const PlotResult drawn =
        single ? writePlots(report.runs.front(), report.options, folder.temporary(), max_plots)
               : writeComparisonPlots(report, folder.temporary());
    report.plots = drawn.files;
    if (!drawn.fault.empty()) warn(drawn.fault);
  }
  folder.adoptAll();
  if (single) markPictures(folder.temporary(), runMark({report.runs.front().id}));
  writeFile(folder.pathFor("report.txt"), textReport(report));
  writeFile(folder.pathFor("report.md"), markdownReport(report));
  writeFile(folder.pathFor("report.json"), jsonReport(report));
  if (single) writeFile(folder.pathFor("instants.csv"), instantsCsv(report.runs.front()));
  if (fs::exists(fs::path(dir) / "report.json")) folder.replace("plots");
  folder.commit("report.json");
  out_folders.push_back(dir);
}

// One report per run, and a joint one of several runs or of conditions.
void EvaluateApp::writeReports() {
  const bool pooled = std::any_of(out_report.runs.begin(), out_report.runs.end(),
                                  [](const EvaluatedRun& run) { return !run.trials.empty(); });
  const bool several = out_report.runs.size() > 1 || pooled;
  if (pooled && output.empty())
    throw Error(ExitCode::kUsage, "-o/--output is needed for the report of conditions");
  for (const EvaluatedRun& run : out_report.runs) {
    stopIfAsked();
    if (!run.trials.empty()) continue;
    EvaluationReport own = emptyReport();
    own.runs.push_back(run);
    dropRowsOfOtherWeathers(own);
    std::string dir = run.dir + "/evaluation";
    // Names that are paths (two runs of the same name) cannot be folder names: these runs are
    // numbered.
    if (!output.empty()) {
      dir = output;
      if (several) {
        const bool is_folder_name = run.name.find('/') == std::string::npos;
        dir += "/" + (is_folder_name ? run.name
                                     : fmt::format("run{}", &run - out_report.runs.data() + 1));
      }
    }
    write(std::move(own), dir);
  }
  if (several && !output.empty()) write(out_report, output);
}

void EvaluateApp::run() {
  params.selection.fov = radians(fov_deg);
  params.selection.complete_fov = radians(complete_fov_deg);
  if (without_truth) return judgeQuality();
  if (!truth_poses.empty())
    params.alignment.truth_poses = std::make_shared<TrackedRun>(readTrackedRun(truth_poses));
  out_report = emptyReport();
  addPaperRows();
  evaluateRuns();
  for (const std::string& table : dropRowsOfOtherWeathers(out_report))
    warn(fmt::format("--paper {}: no run is of that weather: its rows are left out", table));
  writeReports();
  std::string text = summaryText(out_report);
  if (verbosity > 0 || !paper.empty() || !front_ends.empty() || nuscenes)
    text += "\n" + textReport(out_report);
  std::fwrite(text.data(), 1, text.size(), stdout);
  for (const std::string& dir : out_folders) say(1, "written: " + dir);
}

std::unique_ptr<App> evaluateApp() { return std::make_unique<EvaluateApp>(); }

}  // namespace perception
