#include "libperception/evaluation/plots/Plots.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "libperception/core/Error.h"
#include "libperception/evaluation/plots/Gnuplot.h"
#include "tests/evaluation/MakeRun.h"

namespace perception {
namespace {

using namespace testing_evaluation;
namespace fs = std::filesystem;

class Plots : public testing::Test {
 protected:
  void SetUp() override {
    // A name that a careless script or command line would trip over.
    dir_ = testing::TempDir() +
           "it's a plot, fran\xC3\xA7"
           "ais";
    fs::remove_all(dir_);
    fs::create_directories(dir_);
    TrackedRun run = makeRun();
    std::vector<TruthObject> truth;
    for (std::int64_t k = 0; k < 20; ++k) {
      const double x = 15 - 0.5 * static_cast<double>(k);
      truth.push_back(makeTruth(k, 3, x, 2));
      run.scenes.push_back(makeScene(k, {makeObject(k < 10 ? 1 : 2, x + 0.3, 2)}));
    }
    run_ = {"it's \\ a {run}", dir_, evaluate(run, makeGroundTruth(truth), {}), {}};
  }
  void TearDown() override { fs::remove_all(dir_); }
  std::string dir_;
  EvaluatedRun run_;
};

bool isPng(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string head(8, ' ');
  file.read(head.data(), 8);
  return head == "\x89PNG\r\n\x1a\n" && fs::file_size(path) > 5000;
}

TEST_F(Plots, DrawTimelinesOverviewDistancesReliabilityAndObjects) {
  std::ofstream(dir_ + "/gnuplot.log");
  const PlotResult result = writePlots(run_, {}, dir_, 40);
  if (result.fault.find("not installed") != std::string::npos) GTEST_SKIP() << result.fault;
  EXPECT_EQ(result.fault, "");
  EXPECT_EQ(result.files,
            (std::vector<std::string>{"plots/timelines.png", "plots/overview.png",
                                      "plots/set_distance.png", "plots/reliability.png",
                                      "plots/existence.png", "plots/object_3.png"}));
  for (const std::string& file : result.files) EXPECT_TRUE(isPng(dir_ + "/" + file)) << file;
  std::ifstream log(dir_ + "/plots/gnuplot.log");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(log), {}), "");
}

TEST_F(Plots, PicturesOfAnEarlierEvaluationGo) {
  fs::create_directories(dir_ + "/plots");
  std::ofstream(dir_ + "/plots/object_99.png") << "old";
  std::ofstream(dir_ + "/plots/mine.png") << "not ours";
  writePlots(run_, {}, dir_, 0);
  EXPECT_FALSE(fs::exists(dir_ + "/plots/object_99.png"));
  EXPECT_FALSE(fs::exists(dir_ + "/plots/object_3.png"));  // none was asked for
  EXPECT_TRUE(fs::exists(dir_ + "/plots/mine.png"));
}

TEST_F(Plots, WithoutAnyInstantThereIsNothingToDraw) {
  run_.evaluation = evaluate(makeRun(), {}, {});
  const PlotResult result = writePlots(run_, {}, dir_, 40);
  EXPECT_TRUE(result.files.empty());
}

TEST_F(Plots, SeveralRunsAreDrawnIntoTheSamePictures) {
  EvaluationReport report;
  report.runs = {run_, run_};
  report.runs[1].name = "L+R";
  report.paper = paperTrackingRows();
  const PlotResult result = writeComparisonPlots(report, dir_);
  if (result.fault.find("not installed") != std::string::npos) GTEST_SKIP() << result.fault;
  EXPECT_EQ(result.fault, "");
  EXPECT_EQ(result.files,
            (std::vector<std::string>{"plots/comparison.png", "plots/set_distance.png",
                                      "plots/reliability.png", "plots/existence.png"}));
  for (const std::string& file : result.files) EXPECT_TRUE(isPng(dir_ + "/" + file)) << file;
  std::ifstream log(dir_ + "/plots/gnuplot.log");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(log), {}), "");
}

TEST_F(Plots, TrialsHaveNoCommonTime) {
  EvaluationReport report;
  report.runs = {pooledRun("A", {run_, run_}), pooledRun("B", {run_, run_})};
  for (const std::string& file : writeComparisonPlots(report, dir_).files)
    EXPECT_NE(file, "plots/set_distance.png");
}

TEST_F(Plots, AFaultyScriptIsReported) {
  std::ofstream(dir_ + "/bad.gp") << "plot nothing_of_that_name\n";
  EXPECT_NE(runGnuplot(dir_, "bad.gp"), "");
}

TEST_F(Plots, AFolderThatCannotBeCreatedIsAnOutputError) {
  std::ofstream(dir_ + "/plots") << "a file";
  EXPECT_THROW(writePlots(run_, {}, dir_, 40), OutputError);
}

TEST(GnuplotString, QuotesAreDoubledAndControlsGo) {
  EXPECT_EQ(gnuplotString("it's\n\\n"), "'it''s \\n'");
}

}  // namespace
}  // namespace perception
