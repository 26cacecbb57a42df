#include "libperception/app/show/ReportApp.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>
#include <string_view>
#include <tuple>
#include <utility>

#include "libperception/app/Programs.h"
#include "libperception/app/show/CompareRuns.h"
#include "libperception/app/show/ComparisonPage.h"
#include "libperception/app/show/ResultFiles.h"
#include "libperception/pipeline/output/FinishedRun.h"
#include "libperception/scene/files/OutputFile.h"
#include "libperception/scene/files/RunMark.h"
#include "libperception/scene/files/TrackedRunReader.h"
#include "libperception/sensors/observations/registerClasses.h"

namespace perception {
namespace {

namespace fs = std::filesystem;

/// Files of a run's folder shown on the page if they exist.
struct FigureRow {
  const char* file;
  const char* media_type;
  const char* title;
  const char* caption;
};
constexpr FigureRow kVideos[] = {
    {"scene.mp4", "video/mp4", "Video",
     "Left from above, right from behind the vehicle. Boxes: tracked objects; thin black "
     "outlines: truth; points: lidar returns; legend at the right."}};
constexpr FigureRow kPictures[] = {{"scene.png", "image/png", "One instant, large",
                                    "The same view as in the video. Arrow: predicted path of one "
                                    "second; line: path of the last two."},
                                   {"contact.png", "image/png", "Overview of the run",
                                    "Instants at equal intervals, from above."}};
constexpr FigureRow kPlots[] = {
    {"plots/timelines.png", "image/png", "Truth objects over time",
     "One row per truth object: estimated class, missed instants, id switches."},
    {"plots/overview.png", "image/png", "Over time",
     "Above: each truth object, tracked or not, class correct or not. Below: number of true, "
     "missed and false objects at each instant."},
    {"plots/reliability.png", "image/png", "Calibration of the class probability",
     "Observed frequency of the correct class over its stated probability; ideal: the diagonal."}};

}  // namespace

std::string ReportApp::description() const {
  return "Makes one HTML page of a run: video, pictures, timeline, metrics, inputs; or of what "
         "differs "
         "between two.";
}

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
  ReportContent content;
  content.run = readRunOutline(run_dir);
  content.record = readRunRecord((fs::path(run_dir) / "done.json").string());
  const fs::path timing = fs::path(run_dir) / "timing.json";
  if (fs::exists(timing)) content.real_time_factor = jsonOf(timing).value("real_time_factor", 0.0);
  content.id = idOfRun(content.record);
  content.video = figuresIn(run_dir, kVideos, content.id);
  content.pictures = figuresIn(run_dir, kPictures, content.id);
  addOtherPictures(content);
  addEvaluation(content);
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

template <class Rows>
std::vector<ReportContent::Figure> ReportApp::figuresIn(const fs::path& dir, const Rows& rows,
                                                        const std::string& id) {
  std::vector<ReportContent::Figure> figures;
  for (const auto& row : rows) {
    const fs::path file = dir / row.file;
    if (!fs::exists(file)) continue;
    if (isOfRuns(file, {id})) {
      figures.push_back({row.title, row.caption, row.media_type, file.string()});
    } else {
      warnOfOrigin(file);
    }
  }
  return figures;
}

void ReportApp::warnOfOrigin(const fs::path& file) {
  warn(fmt::format("{}: does not say of which run it is: left out; make it again", file.string()));
}

// Pictures of other names in the folder that say that they are of the run.
void ReportApp::addOtherPictures(ReportContent& content) const {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(run_dir)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    const bool png = file.extension() == ".png", jpeg = file.extension() == ".jpg";
    const bool known =
        std::any_of(std::begin(kPictures), std::end(kPictures),
                    [&](const FigureRow& row) { return file.filename() == row.file; });
    if ((!png && !jpeg) || known || !fs::is_regular_file(file)) continue;
    const auto ids = markedRunsOf(file.string());
    if (std::find(ids.begin(), ids.end(), content.id) == ids.end()) continue;
    content.pictures.push_back({file.filename().string(), "From the run's folder.",
                                png ? "image/png" : "image/jpeg", file.string()});
  }
}

void ReportApp::addEvaluation(ReportContent& content) {
  const fs::path dir =
      evaluation_dir.empty() ? fs::path(run_dir) / "evaluation" : fs::path(evaluation_dir);
  const fs::path report = dir / "report.json";
  if (!fs::exists(report)) {
    if (evaluation_dir.empty()) return;
    throw DataError(report.string() + ": there is no such file", ExitCode::kNoInput);
  }
  const nlohmann::json figures = figuresOf(report, content.id);
  if (figures.is_null()) return warnOfOrigin(report);
  content.evaluation = jsonOf(report);
  content.evaluation["runs"] = nlohmann::json::array({figures});
  content.plots = figuresIn(dir, kPlots, content.id);
}

std::unique_ptr<App> reportApp() { return std::make_unique<ReportApp>(); }

}  // namespace perception
