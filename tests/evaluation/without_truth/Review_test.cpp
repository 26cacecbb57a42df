#include "libperception/evaluation/without_truth/Review.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>

#include "libperception/core/Error.h"
#include "libperception/core/math/Random.h"
#include "libperception/evaluation/metrics/ShareInterval.h"
#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

SceneObject objectAt(std::uint64_t id, ClassId c, double x) {
  SceneObject o;
  o.id = id;
  o.class_id = c;
  o.class_probability = {0.02, 0.02, 0.02};
  o.class_probability[static_cast<std::size_t>(c)] = 0.96;
  o.classified = true;
  o.existence = 0.9;
  o.position = Vector3(x, 0, 0);
  return o;
}

/// 20 scenes of a car, a pedestrian in the first five of them, and a pole.
TrackedRun runOfTwo() {
  TrackedRun run;
  run.class_names = {"pedestrian", "car", "static-other"};
  for (int k = 0; k < 20; ++k) {
    Scene scene;
    scene.frame = k;
    scene.stamp = run.first_stamp + 0.1 * k;
    scene.objects = {objectAt(1, 1, 10), objectAt(3, 2, 5)};
    if (k < 5) scene.objects.push_back(objectAt(2, 0, 15));
    run.scenes.push_back(scene);
  }
  return run;
}

ReviewItem answered(std::uint64_t id, ReviewAnswer answer, const char* name = "car",
                    std::size_t outputs = 100) {
  ReviewItem item;
  item.id = id;
  item.class_name = name;
  item.outputs = outputs;
  item.answer = answer;
  return item;
}

TEST(Review, AsksAsOftenOfEachClassAsThereIsSomethingToAsk) {
  ReviewOptions options;
  options.number = 12;
  const auto items = drawReview(runOfTwo(), options, {"static-other"});
  std::map<std::string, std::size_t> asked;
  for (const ReviewItem& item : items) ++asked[item.class_name];
  EXPECT_EQ(asked, (std::map<std::string, std::size_t>{{"car", 7}, {"pedestrian", 5}}));
  EXPECT_TRUE(std::is_sorted(items.begin(), items.end(),
                             [](const auto& a, const auto& b) { return a.t < b.t; }));
  for (const ReviewItem& item : items) EXPECT_EQ(item.outputs, item.class_name == "car" ? 20U : 5U);
}

TEST(Review, DrawsTheSameOutputsForTheSameSeedAndOthersForAnother) {
  ReviewOptions options;
  options.number = 6;
  const auto text = [&] {
    return reviewText("r", drawReview(runOfTwo(), options, {"static-other"}));
  };
  const std::string first = text();
  EXPECT_EQ(text(), first);
  options.seed = 2;
  EXPECT_NE(text(), first);
}

TEST(Review, LeavesOutWhatIsFarUnlikelyOrNotSure) {
  TrackedRun run = runOfTwo();
  for (Scene& scene : run.scenes) scene.objects[0].existence = 0.4;
  ReviewOptions options;
  for (const auto& item : drawReview(run, options, {"static-other"})) EXPECT_EQ(item.id, 2U);
  options.range = 12;
  EXPECT_TRUE(drawReview(run, options, {"static-other"}).empty());
  run = runOfTwo();
  options.range = 40;
  options.sure = true;
  for (Scene& scene : run.scenes) scene.objects[0].classified = false;
  for (const auto& item : drawReview(run, options, {"static-other"})) EXPECT_EQ(item.id, 2U);
}

TEST(Review, AnswersSurviveTheFile) {
  const test::TemporaryFolder folder;
  const std::string path = folder / "answers.csv";
  auto items = drawReview(runOfTwo(), {}, {"static-other"});
  items[0].answer = ReviewAnswer::kYes;
  items[1].answer = ReviewAnswer::kNo;
  std::ofstream(path) << reviewText("abc", items);
  const ReviewAnswers read = readReview(path);
  EXPECT_EQ(read.run, "abc");
  EXPECT_EQ(reviewText(read.run, read.items), reviewText("abc", items));
  std::ofstream(path) << "run,t,id,class,probability,outputs,answer\nr,0.1,1,car,0.9,20,\n"
                         "r,0.2,1,car,0.9,20,maybe\n";
  try {
    readReview(path);
    FAIL() << "maybe is no answer";
  } catch (const DataError& e) {
    EXPECT_NE(std::string(e.what()).find(":3: column 'answer': found 'maybe'"), std::string::npos)
        << e.what();
  }
}

TEST(Review, TheTruthSaysYesNoOrNothing) {
  const TrackedRun run = runOfTwo();
  GroundTruth truth;
  for (int k = 0; k < 10; ++k) {
    TruthObject car;
    car.frame = k;
    car.t = 0.1 * k;
    car.type = "Van";
    car.position = Vector3(11, 0.5, 0);
    TruthObject covered = car;
    covered.type = "DontCare";
    covered.position = Vector3(15, 0, 0);
    covered.ignore = true;
    truth.instants.push_back({k, car.t, {car}});
    if (k == 1) truth.instants.back().objects.push_back(covered);
  }
  std::vector<ReviewItem> items = drawReview(run, {}, {"static-other"});
  answerByTruth(run, truth, {}, items);
  for (const ReviewItem& item : items) {
    const bool known = item.scene < 10 && !(item.id == 2 && item.scene == 1);
    const auto expected = !known         ? ReviewAnswer::kUnsure
                          : item.id == 1 ? ReviewAnswer::kYes
                                         : ReviewAnswer::kNo;
    EXPECT_EQ(item.answer, expected) << item.id << " in scene " << item.scene;
  }
}

TEST(ShareInterval, IsTheOneOfTheBook) {
  // [brown2001], 10 of 100.
  EXPECT_NEAR(wilsonInterval(0.1, 100).low, 0.0552, 5e-4);
  EXPECT_NEAR(wilsonInterval(0.1, 100).high, 0.1744, 5e-4);
  EXPECT_NEAR(wilsonInterval(0, 100).low, 0, 1e-12);
}

TEST(ReviewPrecision, OfDifferentObjectsIsWilsonsInterval) {
  std::vector<ReviewItem> items;
  for (std::uint64_t id = 1; id <= 40; ++id)
    items.push_back(answered(id, id <= 30 ? ReviewAnswer::kYes : ReviewAnswer::kNo));
  const auto rows = reviewPrecision(items);
  ASSERT_EQ(rows.size(), 2U);
  const ShareInterval plain = wilsonInterval(0.75, 39);  // 40 / (40 / 39)
  EXPECT_EQ(rows[0].precision, 0.75);
  EXPECT_NEAR(rows[0].low, plain.low, 1e-9);
  EXPECT_NEAR(rows[0].high, plain.high, 1e-9);
  EXPECT_EQ(rows[1].class_name, "all");
  EXPECT_EQ(rows[1].precision, 0.75);
}

TEST(ReviewPrecision, TenViewsOfEachObjectSayNoMoreThanOne) {
  std::vector<ReviewItem> once, often;
  for (std::uint64_t id = 1; id <= 20; ++id) {
    const auto answer = id <= 15 ? ReviewAnswer::kYes : ReviewAnswer::kNo;
    once.push_back(answered(id, answer));
    for (int view = 0; view < 10; ++view) often.push_back(answered(id, answer));
  }
  const auto a = reviewPrecision(once)[0], b = reviewPrecision(often)[0];
  EXPECT_EQ(b.asked, 200U);
  EXPECT_NEAR(a.low, b.low, 1e-9);
  EXPECT_NEAR(a.high, b.high, 1e-9);
  for (ReviewItem& item : often) item.answer = ReviewAnswer::kYes;
  EXPECT_NEAR(reviewPrecision(often)[0].low, wilsonInterval(1, 20).low, 1e-9);
}

TEST(ReviewPrecision, OfAllWeighsClassesByTheirOutputs) {
  std::vector<ReviewItem> items;
  for (std::uint64_t id = 1; id <= 10; ++id) {
    items.push_back(answered(id, ReviewAnswer::kYes, "car", 900));
    items.push_back(answered(100 + id, ReviewAnswer::kNo, "pedestrian", 100));
  }
  items.push_back(answered(500, ReviewAnswer::kUnsure, "bus", 50));
  const auto rows = reviewPrecision(items);
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_EQ(rows[0].class_name, "bus");
  EXPECT_EQ(rows[0].low, 0);
  EXPECT_EQ(rows[0].high, 1);
  EXPECT_NEAR(rows[3].precision, 0.9, 1e-12);
}

// 500 simulated reviews of 60 objects with one to eight views each, of which all are right or
// wrong.
TEST(ReviewPrecision, LimitsHoldTheTrueShareNineteenTimesInTwenty) {
  int holds = 0;
  constexpr int kTrials = 500;
  constexpr double kShare = 0.8;
  for (int trial = 0; trial < kTrials; ++trial) {
    Rng rng({7, static_cast<std::uint64_t>(trial), 0, 1});
    std::vector<ReviewItem> items;
    for (std::uint64_t id = 1; id <= 60; ++id) {
      const auto answer = rng.uniform() < kShare ? ReviewAnswer::kYes : ReviewAnswer::kNo;
      for (std::uint32_t view = 0; view <= rng.below(8); ++view)
        items.push_back(answered(id, answer));
    }
    const auto row = reviewPrecision(items)[0];
    holds += row.low <= kShare && kShare <= row.high ? 1 : 0;
  }
  EXPECT_GT(holds, 0.92 * kTrials);
  EXPECT_LT(holds, 0.98 * kTrials);
}

}  // namespace
}  // namespace perception
