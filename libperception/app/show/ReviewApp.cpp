#include "libperception/app/show/ReviewApp.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "gui-offscreen/html/ReviewPage.h"
#include "libperception/app/Programs.h"
#include "libperception/core/math/Angle.h"
#include "libperception/pictures/ReviewPictures.h"
#include "libperception/pictures/SnapshotSensors.h"
#include "libperception/scene/files/OutputFile.h"
#include "libperception/scene/files/RunRecord.h"
#include "libperception/sensors/observations/registerClasses.h"

namespace perception {
namespace fs = std::filesystem;
namespace {

RunRecord recordOf(const std::string& run_dir) {
  return readRunRecord((fs::path(run_dir) / "done.json").string());
}

}  // namespace

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
  const auto questions = reviewQuestions(run, record.hash, out_items, sensors);
  out_page = reviewPage(fmt::format("Review of {}{}", fs::path(record.input).filename().string(),
                                    record.simulated ? " (simulated)" : ""),
                        reviewText("", {}), questions);
  createFolder(fs::path(output).parent_path().string());
  writeFile(output, out_page);
  fmt::print("{}: {} questions\n", output, questions.size());
}

void ReviewApp::score() {
  const ReviewAnswers answers = readReview(answers_file);
  if (answers.items.empty()) throw DataError(answers_file + ": nothing is answered");
  if (answers.open > 0)
    warn(fmt::format("{}: {} of {} questions are not answered", answers_file, answers.open,
                     answers.open + answers.items.size()));
  out_items = answers.items;
  out_precision = reviewPrecision(out_items);
  fmt::print("by the answers\n{}", reviewTable(out_precision));
  if (run_dir.empty()) return;
  const RunRecord record = recordOf(run_dir);
  if (record.hash != answers.run)
    throw DataError(fmt::format("{}: answers about another run than {}", answers_file, run_dir));
  if (truth_file.empty()) return;
  const TrackedRun run = readTrackedRun(run_dir);
  placeItems(run, run_dir, answers_file, out_items);
  std::vector<ReviewItem> known = out_items;
  answerByTruth(run, readGroundTruth(truth_file), evaluation, known);
  out_by_truth = reviewPrecision(known);
  const auto [same, both] = sameAnswers(out_items, known);
  fmt::print("of the same outputs by the truth\n{}answers as the truth's: {} of {}\n",
             reviewTable(out_by_truth), same, both);
}

std::unique_ptr<App> reviewApp() { return std::make_unique<ReviewApp>(); }

}  // namespace perception
