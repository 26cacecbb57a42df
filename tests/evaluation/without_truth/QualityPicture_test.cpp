#include "libperception/evaluation/without_truth/QualityPicture.h"

#include <gtest/gtest.h>

#include <map>

#include "tests/evaluation/MakeRun.h"

namespace perception {
namespace {

using namespace testing_evaluation;

std::map<std::string, std::string> dataOf(const StudyPlot& plot) {
  return {plot.data.begin(), plot.data.end()};
}

TEST(QualityPicture, MomentsStandWhereTheObjectsWere) {
  TrackedRun run = makeRun();
  for (int k = 0; k <= 30; ++k) run.scenes.push_back(makeScene(k, {makeObject(1, 10, 0)}));
  for (const std::size_t k : {10U, 11U}) run.scenes[k].objects.push_back(makeObject(2, 5, 4));
  const StudyPlot plot = momentsPicture(run, qualityOf(run, {}, {}), {});
  const auto data = dataOf(plot);
  ASSERT_EQ(data.count("moments1.txt"), 1U);  // less than a second
  EXPECT_EQ(data.at("moments1.txt"), "5.00 4.00 1.000 2\n");
  EXPECT_NE(data.at("numbers.txt").find("5.00 4.00 2\n"), std::string::npos);
  EXPECT_NE(plot.script.find("moments1.txt"), std::string::npos);
}

TEST(QualityPicture, ObjectsWithoutANameAreNotCounted) {
  TrackedRun run = makeRun();
  run.scenes.push_back(makeScene(0, {makeObject(1, 10, 0)}));
  const std::string name =
      run.class_names.at(static_cast<std::size_t>(run.scenes[0].objects[0].class_id));
  QualityOptions named;
  named.unnamed = {name};
  EXPECT_EQ(dataOf(momentsPicture(run, {}, {})).at("counts.txt"), "0.000 1\n");
  EXPECT_EQ(dataOf(momentsPicture(run, {}, named)).at("counts.txt"), "0.000 0\n");
}

TEST(QualityPicture, RunsWithoutAFigureOrAnErrorGiveNoPoint) {
  const std::size_t n = qualityKinds().size();
  FiguresAndErrors both{std::vector<Figure>(n, 0.5), {}}, none{std::vector<Figure>(n), {}};
  both.errors.fill(2.0);
  const StudyPlot plot = followingPicture({both, none});
  ASSERT_FALSE(plot.data.empty());
  for (const auto& [file, text] : plot.data) EXPECT_EQ(text, "2 0.5\n") << file;
  EXPECT_TRUE(followingPicture({none}).data.empty());
}

}  // namespace
}  // namespace perception
