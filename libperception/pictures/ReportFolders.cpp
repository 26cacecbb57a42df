#include "libperception/pictures/ReportFolders.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "libperception/core/Error.h"
#include "libperception/evaluation/plots/Gnuplot.h"
#include "libperception/evaluation/plots/Plots.h"
#include "libperception/pipeline/output/OutputFolder.h"
#include "libperception/pipeline/output/Progress.h"
#include "libperception/scene/files/OutputFile.h"
#include "libperception/scene/files/RunMark.h"

namespace perception {
namespace {

/// Returns what is wrong with the plots, or nothing.
std::string writeEvaluation(EvaluationReport report, const std::string& dir,
                            std::optional<std::size_t> plots) {
  OutputFolder folder(dir);
  const bool single = report.runs.size() == 1 && report.runs.front().trials.empty();
  PlotResult drawn;
  if (plots && !report.runs.empty()) {
    drawn = single ? writePlots(report.runs.front(), report.options, folder.temporary(), *plots)
                   : writeComparisonPlots(report, folder.temporary());
    report.plots = drawn.files;
  }
  folder.adoptAll();
  if (single) markPictures(folder.temporary(), runMark({report.runs.front().id}));
  writeFile(folder.pathFor("report.txt"), textReport(report));
  writeFile(folder.pathFor("report.md"), markdownReport(report));
  writeFile(folder.pathFor("report.json"), jsonReport(report));
  if (single) writeFile(folder.pathFor("instants.csv"), instantsCsv(report.runs.front()));
  if (std::filesystem::exists(dir + "/report.json")) folder.replace("plots");
  folder.commit("report.json");
  return drawn.fault;
}

}  // namespace

std::vector<std::string> writeStudyReport(const StudyReport& report, const std::string& output) {
  std::vector<std::string> faults;
  OutputFolder folder(output);
  for (const auto& table : report.tables)
    writeFile(folder.pathFor(table.name + ".csv"), csvOf(table));
  for (const auto& [file, content] : report.files) writeFile(folder.pathFor(file), content);
  std::string dir;
  for (const auto& plot : report.plots) {
    for (const auto& [file, content] : plot.data) writeFile(folder.pathFor(file), content);
    const std::string script = plot.name + ".gp", path = folder.pathFor(script);
    writeFile(path, fmt::format("set terminal pngcairo size {},{} font 'Sans,11'\n"
                                "set output '{}.png'\n{}",
                                plot.width, plot.height, plot.name, plot.script));
    dir = path.substr(0, path.size() - script.size());
    const std::string fault = runGnuplot(dir.empty() ? "." : dir, script);
    if (fault.empty()) {
      folder.pathFor(plot.name + ".png");
    } else {
      faults.push_back(fault);
    }
  }
  writeFile(folder.pathFor("report.md"), markdownOf(report));
  folder.commit("report.md");
  return faults;
}

std::vector<std::string> writeEvaluations(const EvaluationReport& report, const std::string& output,
                                          std::optional<std::size_t> plots,
                                          const std::function<void(const std::string&)>& warn) {
  const bool pooled = std::any_of(report.runs.begin(), report.runs.end(),
                                  [](const EvaluatedRun& run) { return !run.trials.empty(); });
  const bool several = report.runs.size() > 1 || pooled;
  if (pooled && output.empty())
    throw Error(ExitCode::kUsage, "-o/--output is needed for the report of conditions");
  std::vector<std::string> folders;
  const auto write = [&](EvaluationReport content, const std::string& dir) {
    const std::string fault = writeEvaluation(std::move(content), dir, plots);
    if (!fault.empty()) warn(fault);
    folders.push_back(dir);
  };
  for (const EvaluatedRun& run : report.runs) {
    stopIfAsked();
    if (!run.trials.empty()) continue;
    EvaluationReport own = {
        report.command, report.truth, report.reference, report.options, {run}, report.paper, {}};
    dropRowsOfOtherWeathers(own);
    std::string dir = output.empty() ? run.dir + "/evaluation" : output;
    // Names that are paths (two runs of the same name) cannot be folder names: these runs are
    // numbered.
    if (!output.empty() && several) {
      const bool is_folder_name = run.name.find('/') == std::string::npos;
      dir +=
          "/" + (is_folder_name ? run.name : fmt::format("run{}", &run - report.runs.data() + 1));
    }
    write(std::move(own), dir);
  }
  if (several && !output.empty()) write(report, output);
  return folders;
}

}  // namespace perception
