#include "libperception/app/show/ReviewApp.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "libperception/app/track/TrackApp.h"
#include "libperception/scene/files/RunRecord.h"
#include "tests/app/DemoLog.h"
#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

using namespace test;

template <class AppClass>
int runOf(AppClass& app, const std::vector<std::string>& words, std::string& error) {
  std::vector<const char*> argv;
  for (const std::string& word : words) argv.push_back(word.c_str());
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int code = runApp(app, static_cast<int>(argv.size()), argv.data());
  testing::internal::GetCapturedStdout();
  error = testing::internal::GetCapturedStderr();
  return code;
}

/// A review of the tracked demo from the page to the precision.
TEST(ReviewApp, AnswersOfTheTruthGiveThePrecisionOfTheTruth) {
  const test::TemporaryFolder folder;
  const std::string run = folder / "run", page = folder / "review.html",
                    answers = folder / "answers.csv";
  std::string error;
  TrackApp track;
  ASSERT_EQ(runOf(track,
                  {"perception-track", "-c", PERCEPTION_SOURCE_DIR "/ini/demo.ini", "-i", kDemoLog,
                   "-o", run, "--sensors", "L"},
                  error),
            0)
      << error;

  ReviewApp ask;
  ASSERT_EQ(
      runOf(ask, {"perception-review", "page", "-r", run, "-i", kDemoLog, "-o", page, "-n", "12"},
            error),
      0)
      << error;
  ASSERT_EQ(ask.out_items.size(), 12U);
  std::size_t pictures = 0;
  for (auto i = ask.out_page.find("/9j/"); i != std::string::npos;
       i = ask.out_page.find("/9j/", i + 4))
    ++pictures;  // how JPEG begins in base 64
  EXPECT_GE(pictures, 24U);
  EXPECT_EQ(ask.out_page.find("http"), std::string::npos) << "the page asks the network";

  const TrackedRun tracked = readTrackedRun(run);
  auto items = ask.out_items;
  answerByTruth(tracked, readGroundTruth(kDemoTruth), {}, items);
  const std::string hash = readRunRecord(run + "/done.json").hash;
  std::ofstream(answers) << reviewText(hash, items);
  ReviewApp score;
  ASSERT_EQ(
      runOf(score, {"perception-review", "score", answers, "-r", run, "-t", kDemoTruth}, error), 0)
      << error;
  ASSERT_EQ(score.out_precision.size(), score.out_by_truth.size());
  for (std::size_t i = 0; i < score.out_precision.size(); ++i) {
    EXPECT_EQ(score.out_precision[i].right, score.out_by_truth[i].right);
    EXPECT_EQ(score.out_precision[i].unsure, score.out_by_truth[i].unsure);
  }
  EXPECT_GT(score.out_precision.back().right, 0U);

  std::ofstream(answers) << reviewText("another", items);
  EXPECT_EQ(runOf(score, {"perception-review", "score", answers, "-r", run}, error), 65);
  EXPECT_NE(error.find("another run"), std::string::npos) << error;
}

}  // namespace
}  // namespace perception
