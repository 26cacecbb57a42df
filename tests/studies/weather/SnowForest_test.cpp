#include "studies/weather/SnowForest.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "libperception/core/Error.h"
#include "libperception/core/math/Random.h"

namespace perception {
namespace {

// Ranges of the two kinds are `apart` deviations apart; all else is noise.
std::vector<SnowRow> rows(std::size_t n, double apart, std::uint64_t seed) {
  std::vector<SnowRow> all(n);
  for (std::size_t i = 0; i < n; ++i) {
    Rng rng({seed, i, 0, 1});
    all[i].real = i % 2 == 0;
    for (float& f : all[i].features) f = static_cast<float>(rng.normal());
    all[i].features[0] += all[i].real ? static_cast<float>(apart) : 0;
  }
  return all;
}

TEST(SnowForest, AreaCountsPairsAndHalfOfEqualOnes) {
  std::vector<SnowRow> four(4);
  four[1].real = four[3].real = true;
  EXPECT_DOUBLE_EQ(areaUnderCurve({1, 2, 3, 4}, four), .75);
  EXPECT_DOUBLE_EQ(areaUnderCurve({1, 1, 1, 1}, four), .5);
  EXPECT_DOUBLE_EQ(areaUnderCurve({2, 1, 2, 1}, four), 0);
  EXPECT_DOUBLE_EQ(areaUnderCurve({1, 2}, std::vector<SnowRow>(2)), .5);
}

TEST(SnowForest, TellsWhatDiffersAndNotWhatIsAlike) {
  EXPECT_GT(SnowForest(rows(600, 4, 1), 1).area(rows(600, 4, 2)), .97);
  EXPECT_NEAR(SnowForest(rows(600, 0, 1), 1).area(rows(600, 0, 2)), .5, .08);
}

TEST(SnowForest, FindsTheFeatureThatBetrays) {
  const auto falls = SnowForest(rows(600, 3, 1), 1).importance(rows(600, 3, 2), 1);
  EXPECT_EQ(std::max_element(falls.begin(), falls.end()) - falls.begin(), 0);
  EXPECT_GT(falls[0], .3);
  EXPECT_LT(falls[5], .05);
}

TEST(SnowForest, IsRepeatedByItsSeed) {
  const auto train = rows(300, 1, 1), test = rows(300, 1, 2);
  EXPECT_EQ(SnowForest(train, 3).area(test), SnowForest(train, 3).area(test));
  EXPECT_NE(SnowForest(train, 3).area(test), SnowForest(train, 4).area(test));
}

TEST(SnowForest, RefusesSnowOfOneKind) {
  auto train = rows(20, 0, 1);
  for (SnowRow& row : train) row.real = false;
  EXPECT_THROW(SnowForest(train, 1), DataError);
}

}  // namespace
}  // namespace perception
