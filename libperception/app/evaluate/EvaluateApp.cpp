#include "libperception/app/evaluate/EvaluateApp.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "libperception/app/Programs.h"
#include "libperception/core/math/Angle.h"
#include "libperception/evaluation/RunEvaluator.h"
#include "libperception/evaluation/without_truth/QualityReport.h"
#include "libperception/pictures/ReportFolders.h"
#include "libperception/pipeline/output/FinishedRun.h"
#include "libperception/pipeline/output/Progress.h"
#include "libperception/scene/files/RunRecord.h"
#include "libperception/scene/files/TrackedRun.h"

namespace perception {

namespace fs = std::filesystem;

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

void EvaluateApp::evaluateRuns() {
  RunEvaluator evaluator(
      {params, truth_poses, reference, front_ends, any_truth, surroundings, nuscenes},
      [this](const std::string& text) { warn(text); },
      [this](const std::string& text) { say(1, text); });
  out_report = {command(), manifest.empty() ? truth_file : manifest,
                reference, evaluator.options().params,
                {},        paperRowsOf(paper),
                {}};
  const std::vector<RunEntry> all = runEntries(runs, truth_file, manifest);
  const std::vector<std::string> names = namesOfRuns(all);
  std::vector<std::string> conditions;
  std::vector<EvaluatedRun> evaluated;
  for (std::size_t i = 0; i < all.size(); ++i) {
    stopIfAsked();
    conditions.push_back(all[i].condition);
    evaluated.push_back(evaluator.evaluated(all[i], names[i]));
    if (const std::string file = all[i].dir + "/done.json"; fs::exists(file))
      evaluated.back().id = idOfRun(readRunRecord(file));
  }
  out_report.runs = pooledByCondition(conditions, std::move(evaluated));
}

void EvaluateApp::run() {
  params.selection.fov = radians(fov_deg);
  params.selection.complete_fov = radians(complete_fov_deg);
  if (without_truth) return judgeQuality();
  evaluateRuns();
  for (const std::string& table : dropRowsOfOtherWeathers(out_report))
    warn(fmt::format("--paper {}: no run is of that weather: its rows are left out", table));
  const auto most = plots ? std::optional<std::size_t>(kMostPlots) : std::nullopt;
  out_folders =
      writeEvaluations(out_report, output, most, [this](const std::string& text) { warn(text); });
  std::string text = summaryText(out_report);
  if (verbosity > 0 || !paper.empty() || !front_ends.empty() || nuscenes)
    text += "\n" + textReport(out_report);
  std::fwrite(text.data(), 1, text.size(), stdout);
  for (const std::string& dir : out_folders) say(1, "written: " + dir);
}

// Figures that need no truth, and, where there is one, how they follow the true errors.
void EvaluateApp::judgeQuality() {
  const bool has_truth = !truth_file.empty() || !manifest.empty();
  std::vector<RunEntry> entries;
  if (has_truth)
    entries = runEntries(runs, truth_file, manifest);
  else
    for (const std::string& dir : runs) entries.push_back({"", dir, ""});
  if (entries.empty()) throw Error(ExitCode::kUsage, "-r: expected a run");
  const std::vector<std::string> names = namesOfRuns(entries);
  std::vector<JudgedRun> judged(entries.size());
  RunEvaluatorOptions plain;
  plain.params = params;
  RunEvaluator truths(plain, {}, {});
  for (std::size_t i = 0; i < entries.size(); ++i) {
    stopIfAsked();
    judged[i].name = names[i], judged[i].condition = entries[i].condition;
    if (const std::string file = entries[i].dir + "/done.json"; fs::exists(file))
      judged[i].record = readRunRecord(file);
    judged[i].run = readTrackedRun(entries[i].dir);
    if (!entries[i].truth.empty())
      judged[i].errors =
          trueErrors(evaluate(judged[i].run, truths.truth(entries[i].truth), params));
  }
  const StudyReport report = qualityReport(judged, {params.selection, params.unnamed}, has_truth);
  const std::string folder = output.empty() ? entries.front().dir + "/quality" : output;
  for (const std::string& fault : writeStudyReport(report, folder)) warn(fault);
  fmt::print("{}\nReport: {}/report.md\n", markdownOf(report), folder);
}

std::unique_ptr<App> evaluateApp() { return std::make_unique<EvaluateApp>(); }

}  // namespace perception
