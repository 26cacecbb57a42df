#include "libperception/app/show/ReportApp.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string_view>
#include <tuple>
#include <utility>

#include "libperception/app/Programs.h"
#include "libperception/pictures/pages/CompareRuns.h"
#include "libperception/pictures/pages/ComparisonPage.h"
#include "libperception/pictures/pages/ResultFiles.h"
#include "libperception/pipeline/output/FinishedRun.h"
#include "libperception/scene/files/OutputFile.h"
#include "libperception/scene/files/TrackedRunReader.h"
#include "libperception/sensors/observations/registerClasses.h"

namespace perception {

namespace fs = std::filesystem;

void ReportApp::declare(CLI::App& cli) {
  cli.add_option("-r,--run", run_dir, "folder of a run of perception-track")->type_name("DIR");
  addInputOption(cli, false);
  cli.get_option("--input")->expected(1);
  addConfigOptions(cli, false);
  cli.add_option("-t,--truth", truth_file,
                 "truth of the log; default: LOG.truth.csv beside the log of -i")
      ->type_name("FILE");
  cli.add_option("--evaluation", evaluation_dir,
                 "folder of perception-evaluate; default: evaluation/ of the run")
      ->type_name("DIR");
  cli.add_option("-o,--output", output, "output; default: index.html in the run's folder")
      ->type_name("FILE.html");
  CLI::Option* compare =
      cli.add_option(
             "--compare", compared_dirs,
             "folders of two runs of the same log: both in one view, and what differs, object by "
             "object; needs -o")
          ->expected(2)
          ->type_name("A B");
  cli.add_option("--film", film,
                 "with --compare: the film of both runs that perception-snapshot -r A -r B --video "
                 "FILE made")
      ->needs(compare)
      ->type_name("FILE.mp4");
  for (const char* option : {"--run", "--config", "--set", "--print-config", "--evaluation"}) {
    compare->excludes(cli.get_option(option));
  }
}

void ReportApp::run() {
  if (!compared_dirs.empty()) return compare();
  if (run_dir.empty()) throw Error(ExitCode::kUsage, "-r or --compare is required");
  ReportContent content =
      contentOf(run_dir, evaluation_dir, [this](const std::string& file) { warnOfOrigin(file); });
  ReportSources sources = sourcesOf(content.record);
  if (const fs::path events = fs::path(run_dir) / "events.jsonl"; fs::exists(events))
    sources.events = events.string();
  const std::string path = output.empty() ? (fs::path(run_dir) / "index.html").string() : output;
  CollectedRun collected = collectRun(content.run, content.record, sources, "run", path);
  content.lives = std::move(collected.lives);
  content.phantoms = std::move(collected.phantoms);
  content.parts = std::move(collected.parts);
  writePage(path, [&](const TextSink& sink) { writeHtmlPage(content, sink); });
}

void ReportApp::writePage(const std::string& path,
                          const std::function<void(const TextSink&)>& write) {
  OutputFile page(path);
  write([&page](std::string_view text) { page.write(text); });
  page.close();
  out_path = path;
  fmt::print("{}\n", path);
}

void ReportApp::compare() {
  if (output.empty()) throw Error(ExitCode::kUsage, "--compare: -o is required");
  RunComparison comparison = readComparison(compared_dirs.at(0), compared_dirs.at(1));
  for (const std::string& file : comparison.without_origin) warnOfOrigin(file);
  if (!film.empty()) {
    if (!fs::exists(film)) throw DataError(film + ": there is no such file", ExitCode::kNoInput);
    if (!isOfRuns(film, {idOfRun(comparison.a.record), idOfRun(comparison.b.record)}))
      throw DataError(film +
                      ": does not say of which runs it is: make it with perception-snapshot");
    comparison.film = film;
  }
  // Sensor data of the log are with the first run; both have its origin.
  run_dir = comparison.a.dir;
  const ComparedRun &a = comparison.a, &b = comparison.b;
  ReportSources sources = sourcesOf(a.record), others;
  const bool judged = sources.truth.has_value();
  if (judged) others.truth.emplace(truthFile());
  others.origin = a.tracked.scenes.empty()
                      ? Vector3(Vector3::Zero())
                      : Vector3(a.tracked.scenes.front().ego.T_world_ego.translation());
  for (const auto& [run, of, name] : {std::tuple(&a, &sources, "a"), std::tuple(&b, &others, "b")})
    comparison.parts.push_back(
        collectRun(readRunOutline(run->dir), run->record, *of, name, output).parts);
  writePage(output, [&](const TextSink& sink) { writeComparisonPage(comparison, sink); });
}

// Of -t, else beside the log; empty: none.
std::string ReportApp::truthFile() const {
  if (!truth_file.empty() || inputs.empty()) return truth_file;
  const fs::path beside = fs::path(inputs[0]).replace_extension(".truth.csv");
  return fs::exists(beside) ? beside.string() : "";
}

// Truth and sensor data of the log, where it is given.
ReportSources ReportApp::sourcesOf(const RunRecord& record) {
  ReportSources sources;
  if (inputs.size() > 1) throw Error(ExitCode::kUsage, "-i: one log, that of the run");
  if (const std::string truth = truthFile(); !truth.empty()) sources.truth.emplace(truth);
  if (inputs.empty()) return sources;
  const std::string log = fs::path(inputs[0]).filename().string();
  if (log != fs::path(record.input).filename().string()) {
    throw DataError(
        fmt::format("{}: {} is a run of another log: {}", inputs[0], run_dir, record.input));
  }
  registerPerceptionClasses();
  sources.sensors = std::make_unique<SnapshotSensors>(inputs[0], *sources.window, sensorParams());
  return sources;
}

// Of -c, else of the run's effective.ini, so that returns and measurements are those of the
// tracker.
SnapshotSensorParams ReportApp::sensorParams() {
  const std::string given = config_file;
  const std::string own = (fs::path(run_dir) / "effective.ini").string();
  if (given.empty() && fs::exists(own)) config_file = own;
  SnapshotSensorParams params;
  Config config = loadConfig();
  params.read(config, !config_file.empty());
  config_file = given;
  config.finish();
  return params;
}

void ReportApp::warnOfOrigin(const std::string& file) {
  warn(file + ": does not say of which run it is: left out; make it again");
}

std::unique_ptr<App> reportApp() { return std::make_unique<ReportApp>(); }

}  // namespace perception
