#include "libperception/measurement/objects/ExtentUpdate.h"

#include <gtest/gtest.h>

namespace perception {
namespace {

ObjectClass car() {
  ObjectClass c;
  c.shape = ObjectShape::kVehicle;
  c.length = 4.5, c.length_sigma = 0.675, c.width = 1.8, c.width_sigma = 0.27;
  return c;
}

TEST(BoundedExtent, ACarIsAtMostThreeDeviationsWiderThanTheMean) {
  Extent extent;
  extent.length = 7.2, extent.width = 3.8, extent.var_length = 0.02;
  const Extent bounded = boundedExtent(extent, car(), true);
  EXPECT_DOUBLE_EQ(bounded.length, 7.2) << "a bus taken for a car keeps its length";
  EXPECT_DOUBLE_EQ(bounded.width, 1.8 + 3 * 0.27);
  EXPECT_DOUBLE_EQ(bounded.var_length, 0.02);
}

TEST(BoundedExtent, ACarIsAtMostFourDeviationsShorterThanTheMean) {
  Extent extent;
  extent.length = 1, extent.width = 1.7;
  const Extent bounded = boundedExtent(extent, car(), true);
  EXPECT_DOUBLE_EQ(bounded.length, 4.5 - 4 * 0.675) << "what is shorter is a part of one";
  EXPECT_DOUBLE_EQ(bounded.width, 1.7);
  EXPECT_DOUBLE_EQ(boundedExtent(extent, car(), false).length, 1) << "a detector's box";
}

TEST(BoundedExtent, ACyclistIsAtMostThreeDeviationsLongerThanTheMean) {
  ObjectClass cyclist = car();
  cyclist.shape = ObjectShape::kCyclist;
  cyclist.length = 1.8, cyclist.length_sigma = 0.2;
  Extent extent;
  extent.length = 5.3, extent.width = 0.6;
  EXPECT_DOUBLE_EQ(boundedExtent(extent, cyclist, true).length, 2.4) << "what is longer is none";
  EXPECT_DOUBLE_EQ(boundedExtent(extent, cyclist, false).length, 5.3) << "a detector's box";
}

TEST(BoundedExtent, APossibleSizeIsKept) {
  Extent extent;
  extent.length = 5.6, extent.width = 0.4;
  const Extent bounded = boundedExtent(extent, car(), true);
  EXPECT_DOUBLE_EQ(bounded.length, 5.6);
  EXPECT_DOUBLE_EQ(bounded.width, 0.4);
}

TEST(UpdateExtent, AnIncompleteSideOnlyRaisesAMean) {
  Extent extent;
  extent.length = 4, extent.width = 1.8, extent.var_length = extent.var_width = 0.1;
  PartialBox sides;
  sides.yaw = 0, sides.length = 5, sides.width = 1;
  sides.length_complete = sides.width_complete = false;
  const Extent updated = updateExtent(extent, sides, 0, 0.5);
  EXPECT_DOUBLE_EQ(updated.length, 5);
  EXPECT_DOUBLE_EQ(updated.width, 1.8);
}

}  // namespace
}  // namespace perception
