#include "gui-offscreen/drawing/LabelLayout.h"

#include <gtest/gtest.h>

#include "libperception/core/math/Random.h"

namespace perception {
namespace {

const Rect kArea{0, 0, 800, 600};

TEST(LabelLayout, StandsAboveALonelyObject) {
  const Rect object{300, 300, 40, 20};
  const auto places = placeLabels({{object, 100, 14}}, {}, kArea);
  ASSERT_TRUE(places[0]);
  EXPECT_FALSE(places[0]->overlaps(object));
  EXPECT_LE(places[0]->bottom(), object.y);
  EXPECT_NEAR(places[0]->x + 50, 320, 1e-6);
}

TEST(LabelLayout, NeverOverlapsLabelsAndStaysOnThePicture) {
  Rng random({3, 0, 0, 0});
  std::vector<LabelWish> wishes;
  for (int i = 0; i < 120; ++i) {
    wishes.push_back({{random.uniform(0, 780), random.uniform(0, 590), 15, 10}, 110, 14, i});
  }
  const std::vector<Rect> taken = {{700, 550, 90, 40}};
  const auto places = placeLabels(wishes, taken, kArea);
  std::size_t placed = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!places[i]) continue;
    ++placed;
    EXPECT_TRUE(kArea.contains(*places[i]));
    EXPECT_FALSE(places[i]->overlaps(taken[0]));
    for (std::size_t j = 0; j < i; ++j) {
      if (places[j]) {
        EXPECT_FALSE(places[i]->overlaps(*places[j])) << i << " and " << j;
      }
    }
  }
  EXPECT_GT(placed, 80U);
}

TEST(LabelLayout, LowerRanksChooseFirst) {
  const Rect object{400, 300, 10, 10};
  const LabelWish late{object, 100, 14, 2}, early{object, 100, 14, 1};
  const auto places = placeLabels({late, early}, {}, kArea);
  const auto alone = placeLabels({early}, {}, kArea);
  ASSERT_TRUE(places[0] && places[1] && alone[0]);
  EXPECT_DOUBLE_EQ(places[1]->x, alone[0]->x);
  EXPECT_DOUBLE_EQ(places[1]->y, alone[0]->y);
}

TEST(LabelLayout, LeavesOutWhatFindsNoRoom) {
  const auto places = placeLabels({{{400, 300, 10, 10}, 100, 14}}, {kArea}, kArea);
  EXPECT_FALSE(places[0]);
}

}  // namespace
}  // namespace perception
