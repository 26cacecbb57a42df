#include "studies/obstacles/StopCount.h"

#include <gtest/gtest.h>

namespace perception {
namespace {

Stamp at(double t) { return Stamp{1'000'000'000} + t; }

TEST(StopCount, ScansInARowAreOneStop) {
  StopCount count;
  for (const double t : {0.0, 0.1, 0.2, 0.6, 1.5}) count.add(at(t), true, InTheWay::kNo);
  EXPECT_EQ(count.falsely.scans, 5u);
  EXPECT_EQ(count.falsely.stops, 2u);
}

TEST(StopCount, WhatPerhapsIsInTheWayCountsNeitherWay) {
  StopCount count;
  count.add(at(0), true, InTheWay::kPerhaps);
  count.add(at(0.1), false, InTheWay::kPerhaps);
  count.add(at(0.2), false, InTheWay::kNo);
  EXPECT_EQ(count.rightly.scans + count.falsely.scans + count.missed.scans, 0u);
}

TEST(StopCount, NotToStopForWhatIsThereIsMissed) {
  StopCount count;
  count.add(at(0), true, InTheWay::kYes);
  count.add(at(0.1), false, InTheWay::kYes);
  EXPECT_EQ(count.rightly.stops, 1u);
  EXPECT_EQ(count.missed.stops, 1u);
  StopCount sum = count;
  sum += count;
  EXPECT_EQ(sum.missed.scans, 2u);
}

}  // namespace
}  // namespace perception
