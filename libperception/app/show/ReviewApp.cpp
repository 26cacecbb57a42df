#include "libperception/app/show/ReviewApp.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <tuple>
#include <utility>

#include "gui-offscreen/html/ReviewPage.h"
#include "libperception/app/Programs.h"
#include "libperception/core/math/Angle.h"
#include "libperception/pictures/ReviewPictures.h"
#include "libperception/pictures/RunScenes.h"
#include "libperception/pictures/SnapshotSensors.h"
#include "libperception/pipeline/output/Progress.h"
#include "libperception/scene/files/OutputFile.h"
#include "libperception/scene/files/RunRecord.h"
#include "libperception/sensors/observations/registerClasses.h"

namespace perception {
namespace fs = std::filesystem;
namespace {

RunRecord recordOf(const std::string& run_dir) {
  return readRunRecord((fs::path(run_dir) / "done.json").string());
}

std::string tableOf(const std::vector<ReviewPrecision>& rows) {
  std::string out = fmt::format("{:<14}{:>9}{:>7}{:>9}{:>7}{:>8}  {}\n", "class", "outputs",
                                "asked", "objects", "right", "unsure", "precision, 95 % limits");
  for (const ReviewPrecision& r : rows) {
    out += fmt::format("{:<14}{:>9}{:>7}{:>9}{:>7}{:>8}", r.class_name, r.outputs, r.asked,
                       r.objects, r.right, r.unsure);
    out += r.asked > r.unsure
               ? fmt::format("  {:.3f} ({:.3f} to {:.3f})\n", r.precision, r.low, r.high)
               : "  not known\n";
  }
  return out;
}

/// The line of an item without its answer.
std::string rowOf(const std::string& run, const ReviewItem& item) {
  std::string text = reviewText(run, {item});
  text.erase(0, text.find('\n') + 1);
  return text.substr(0, text.rfind(','));
}

std::string headerOf() { return reviewText("", {}); }

}  // namespace

std::string ReviewApp::description() const {
  return "Lets a person say whether outputs of a run are right, where there is no truth: a page of "
         "questions, and the precision by the answers.";
}

void ReviewApp::declare(CLI::App& cli) {
  cli.require_subcommand(1);
  auto* page = cli.add_subcommand("page", "write the page of questions");
  page->add_option("-r,--run", run_dir, "folder of a run of perception-track")
      ->required()
      ->type_name("DIR");
  page->add_option("-i,--input", inputs, "the log of the run: what is drawn")
      ->required()
      ->expected(1)
      ->type_name("LOG");
  page->add_option("-o,--output", output, "the page, FILE.html")->required()->type_name("FILE");
  page->add_option("-n,--number", options.number, "number of outputs that are asked about")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  page->add_option("--seed", options.seed, "seed of the random choice of outputs")
      ->capture_default_str();
  page->add_option("--range", options.range, "outputs up to this distance [m]")
      ->check(CLI::Range(1.0, 500.0))
      ->capture_default_str();
  page->add_option("--fov-deg", fov_deg, "whole angle ahead of the outputs [deg]")
      ->check(CLI::Range(1.0, 360.0))
      ->capture_default_str();
  page->add_option("--min-existence", options.min_existence,
                   "outputs with a lower existence are not asked about")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  page->add_flag("--sure", options.sure, "only outputs with a class probability of at least .95");
  auto* score = cli.add_subcommand("score", "precision by the answers");
  score->add_option("answers", answers_file, "answers.csv, saved by the page")
      ->required()
      ->type_name("ANSWERS.csv");
  score->add_option("-r,--run", run_dir, "folder of the run that was asked about")
      ->type_name("DIR");
  score->add_option("-t,--truth", truth_file, "truth of the log, for comparison: FILE.truth.csv")
      ->needs(score->get_option("--run"))
      ->type_name("FILE");
  score
      ->add_option("--tolerance", evaluation.tolerance,
                   "greatest distance of the centers of truth and output [m]")
      ->check(CLI::Range(0.01, 100.0))
      ->capture_default_str();
  score
      ->add_option("--complete-fov-deg", complete_fov_deg,
                   "whole angle ahead in which the truth knows every object (KITTI: 80) [deg]")
      ->check(CLI::Range(0.1, 360.0))
      ->capture_default_str();
  score->callback([this] { scoring_ = true; });
}

void ReviewApp::run() {
  options.fov = radians(fov_deg);
  evaluation.selection.complete_fov = radians(complete_fov_deg);
  if (scoring_) {
    score();
  } else {
    makePage();
  }
}

void ReviewApp::makePage() {
  registerPerceptionClasses();
  const TrackedRun run = readTrackedRun(run_dir);
  const RunRecord record = recordOf(run_dir);
  out_items = drawReview(run, options, evaluation.unnamed);
  if (out_items.empty())
    throw DataError(fmt::format("{}: no output of a named class within {} m and {} deg", run_dir,
                                options.range, fov_deg));
  config_file = (fs::path(run_dir) / "effective.ini").string();
  Config config = loadConfig();
  SnapshotSensorParams params;
  params.read(config, true);
  SnapshotSensors sensors(inputs[0], run, params);
  ReviewPictures pictures;
  std::vector<ReviewQuestion> questions;
  Progress progress("drawing", out_items.size());
  for (const ReviewItem& item : out_items) {
    stopIfAsked();
    SceneView view = viewOfScene(run, item.scene, nullptr);
    sensors.advanceTo(view.scene.stamp);
    sensors.fill(view);
    ReviewQuestion q{
        item.t, std::to_string(item.id), item.class_name, rowOf(record.hash, item), {}};
    if (auto image = pictures.fromCamera(view, item.object))
      q.pictures.push_back(std::move(*image));
    q.pictures.push_back(pictures.fromVehicle(view, item.object));
    q.pictures.push_back(pictures.fromAbove(view, item.object));
    questions.push_back(std::move(q));
    progress.update(questions.size(), questions.size());
  }
  out_page = reviewPage(fmt::format("Review of {}{}", fs::path(record.input).filename().string(),
                                    record.simulated ? " (simulated)" : ""),
                        headerOf(), questions);
  createFolder(fs::path(output).parent_path().string());
  writeFile(output, out_page);
  fmt::print("{}: {} questions\n", output, questions.size());
}

// Finds the outputs that were asked about: by id and time.
void ReviewApp::findItems(const TrackedRun& run, const ReviewAnswers& answers) {
  std::map<std::pair<std::int64_t, std::uint64_t>, std::pair<std::size_t, std::size_t>> places;
  const auto nanoseconds = [](double t) {
    return static_cast<std::int64_t>(std::llround(t * 1e9));
  };
  for (std::size_t s = 0; s < run.scenes.size(); ++s) {
    const Scene& scene = run.scenes[s];
    for (std::size_t o = 0; o < scene.objects.size(); ++o)
      places[{nanoseconds(scene.stamp - run.first_stamp), scene.objects[o].id}] = {s, o};
  }
  out_items = answers.items;
  for (ReviewItem& item : out_items) {
    const auto found = places.find({nanoseconds(item.t), item.id});
    if (found == places.end())
      throw DataError(fmt::format("{}: object {} at t = {} s is not in {}", answers_file, item.id,
                                  item.t, run_dir));
    std::tie(item.scene, item.object) = found->second;
  }
}

void ReviewApp::score() {
  const ReviewAnswers answers = readReview(answers_file);
  if (answers.items.empty()) throw DataError(answers_file + ": nothing is answered");
  if (answers.open > 0)
    warn(fmt::format("{}: {} of {} questions are not answered", answers_file, answers.open,
                     answers.open + answers.items.size()));
  out_items = answers.items;
  out_precision = reviewPrecision(out_items);
  fmt::print("by the answers\n{}", tableOf(out_precision));
  if (run_dir.empty()) return;
  const RunRecord record = recordOf(run_dir);
  if (record.hash != answers.run)
    throw DataError(fmt::format("{}: answers about another run than {}", answers_file, run_dir));
  if (truth_file.empty()) return;
  const TrackedRun run = readTrackedRun(run_dir);
  findItems(run, answers);
  const std::vector<ReviewItem> said = out_items;
  std::vector<ReviewItem> known = said;
  answerByTruth(run, readGroundTruth(truth_file), evaluation, known);
  out_by_truth = reviewPrecision(known);
  std::size_t both = 0, same = 0;
  for (std::size_t i = 0; i < said.size(); ++i) {
    if (said[i].answer == ReviewAnswer::kUnsure || known[i].answer == ReviewAnswer::kUnsure)
      continue;
    ++both;
    same += said[i].answer == known[i].answer ? 1 : 0;
  }
  fmt::print("of the same outputs by the truth\n{}answers as the truth's: {} of {}\n",
             tableOf(out_by_truth), same, both);
}

std::unique_ptr<App> reviewApp() { return std::make_unique<ReviewApp>(); }

}  // namespace perception
