#include "libperception/app/EvaluateApp.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <set>
#include <system_error>

#include "libperception/core/Angle.h"
#include "libperception/evaluation/Plots.h"
#include "libperception/scene/OutputFile.h"
#include "libperception/scene/TrackedRun.h"

namespace perception {
namespace {

namespace fs = std::filesystem;

// The last folder of the path; a run's name in the tables.
std::string lastPart(const std::string& path) {
  const fs::path normal = fs::absolute(path).lexically_normal();
  return (normal.has_filename() ? normal.filename() : normal.parent_path().filename()).string();
}

// Short names where they tell the runs apart, else the paths as given.
std::vector<std::string> namesOf(const std::vector<std::string>& runs) {
  std::vector<std::string> names;
  std::set<std::string> distinct;
  for (const std::string& run : runs) {
    names.push_back(lastPart(run));
    distinct.insert(names.back());
  }
  return distinct.size() == runs.size() ? names : runs;
}

void createFolder(const std::string& dir) {
  std::error_code failed;
  fs::create_directories(dir, failed);
  if (failed) throw OutputError(fmt::format("{}: cannot be created: {}", dir, failed.message()));
}

}  // namespace

std::string EvaluateApp::description() const {
  return "Holds tracked runs against the truth of their log: the paper's table, GOSPA, false "
         "objects, plots.";
}

void EvaluateApp::declare(CLI::App& cli) {
  cli.add_option("-r,--run", runs, "folder of a run of perception-track; several make one table")
      ->required()
      ->type_name("DIR");
  cli.add_option("-t,--truth", truth_file, "truth of the log, FILE.truth.csv")
      ->required()
      ->type_name("FILE");
  addOutputOption(cli, false);
  cli.add_option("--range", params.selection.range, "truth counts up to this distance [m]")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 1e4));
  cli.add_option("--fov-deg", fov_deg, "whole angle ahead in which truth counts [deg]")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 360.0));
  cli.add_option("--complete-fov-deg", complete_fov_deg,
                 "whole angle ahead in which the truth knows every object (KITTI: 80); no output "
                 "beyond is false [deg]")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 360.0));
  cli.add_option("--min-points", params.selection.min_points,
                 "truth counts from this many lidar returns on, where counted")
      ->capture_default_str()
      ->check(CLI::Range(0, 1000000));
  cli.add_option("--max-occluded", params.selection.max_occluded,
                 "truth counts up to this KITTI occlusion (0-3)")
      ->capture_default_str()
      ->check(CLI::Range(0, 3));
  cli.add_option("--tolerance", params.tolerance,
                 "greatest distance of the centres of truth and estimate [m]")
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
                 "nearest truth of a scene matched by time [s]")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 10.0));
  cli.add_flag("--empty-frames", params.alignment.empty_frames,
               "a scene without a truth line holds no objects (else nothing is known of it)");
  cli.add_option("--unnamed", params.unnamed, "classes that are neither true nor false to output")
      ->delimiter(',')
      ->type_name("NAME,...")
      ->capture_default_str();
  cli.add_option("--sensors", params.sensors,
                 "sensor set of the run for denominator B, C+L+R (else: what hit an object)");
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
  text += " -t " + truth_file;
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
  if (!reference.empty()) text += " --reference " + reference;
  return text;
}

EvaluationReport EvaluateApp::emptyReport() const {
  EvaluationReport report;
  report.command = command();
  report.truth = truth_file;
  report.reference = reference;
  report.options = params;
  return report;
}

void EvaluateApp::evaluateRuns() {
  const GroundTruth truth = readGroundTruth(truth_file);
  std::optional<TrackedRun> reference_run;
  if (!reference.empty()) reference_run = readTrackedRun(reference);
  const std::vector<std::string> names = namesOf(runs);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    stopIfAsked();
    const TrackedRun run = readTrackedRun(runs[i]);
    EvaluatedRun evaluated{names[i], runs[i], evaluate(run, truth, params), {}};
    if (reference_run) evaluated.count_difference = countDifference(run, *reference_run);
    warnOfGaps(evaluated);
    out_report.runs.push_back(std::move(evaluated));
  }
}

void EvaluateApp::warnOfGaps(const EvaluatedRun& run) {
  const TruthAlignment& alignment = run.evaluation.alignment;
  if (run.evaluation.instants.empty()) {
    warn(
        fmt::format("{}: no scene has a truth in {} (other log, or times more than {:g} s apart): "
                    "every figure is n/a",
                    run.dir, truth_file, params.alignment.time_limit));
  } else if (run.evaluation.samples.empty()) {
    warn(fmt::format("{}: no truth object counts: tracking figures are n/a", run.dir));
  }
  if (!run.evaluation.instants.empty() && alignment.scenes_without_truth > 0) {
    say(1, fmt::format("{}: {} scenes without truth are in no figure", run.dir,
                       alignment.scenes_without_truth));
  }
  if (!run.evaluation.instants.empty() && alignment.truth_without_scene > 0) {
    say(1, fmt::format("{}: {} truth instants without scene are in no figure", run.dir,
                       alignment.truth_without_scene));
  }
}

void EvaluateApp::write(EvaluationReport report, const std::string& dir) {
  createFolder(dir);
  // A joint report has the tables only; each run has its own pictures.
  if (plots && report.runs.size() == 1) {
    const PlotResult drawn = writePlots(report.runs.front(), report.options, dir, max_plots);
    report.plots = drawn.files;
    if (!drawn.fault.empty()) warn(drawn.fault);
  }
  writeFile(dir + "/report.txt", textReport(report));
  writeFile(dir + "/report.md", markdownReport(report));
  writeFile(dir + "/report.json", jsonReport(report));
  out_folders.push_back(dir);
}

void EvaluateApp::writeReports() {
  const bool several = out_report.runs.size() > 1;
  for (const EvaluatedRun& run : out_report.runs) {
    stopIfAsked();
    EvaluationReport own = emptyReport();
    own.runs.push_back(run);
    std::string dir = run.dir + "/evaluation";
    // Names that are paths (two runs of one name) cannot be folders: such runs are numbered.
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
  out_report = emptyReport();
  evaluateRuns();
  writeReports();
  const std::string text = textReport(out_report);
  std::fwrite(text.data(), 1, text.size(), stdout);
  for (const std::string& dir : out_folders) say(1, "written: " + dir);
}

}  // namespace perception
