#include "libperception/interop/ros/PoseSeries.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <utility>

namespace perception {
namespace {

constexpr std::size_t kManyPoses = 5000;  // more than are kept in memory

Pose3 placed(double x) { return makePose(x, 2, 3, 0.4, 0.1, -0.2); }

TEST(PoseSeries, PosesOfALongDriveComeBackAsTheyWereAdded) {
  PoseSeries series;
  for (std::size_t i = 0; i < kManyPoses; ++i)
    series.add(Stamp{static_cast<std::int64_t>(10 * i)}, placed(static_cast<double>(i)));
  ASSERT_EQ(series.size(), kManyPoses);
  for (const std::size_t i : {std::size_t{0}, std::size_t{4999}, std::size_t{1023},
                              std::size_t{1024}, std::size_t{3000}}) {
    EXPECT_EQ(series.row(i).stamp.ns, static_cast<std::int64_t>(10 * i));
    EXPECT_EQ(series.row(i).pose.matrix(), placed(static_cast<double>(i)).matrix());
  }
}

TEST(PoseSeries, TheFirstPoseFromAStampOnIsFoundInEveryBlock) {
  PoseSeries series;
  EXPECT_EQ(series.firstFrom(Stamp{5}), 0U);
  for (std::size_t i = 0; i < kManyPoses; ++i)
    series.add(Stamp{static_cast<std::int64_t>(10 * i)}, placed(0));
  for (std::size_t i = 0; i < kManyPoses; i += 127) {
    const auto ns = static_cast<std::int64_t>(10 * i);
    EXPECT_EQ(series.firstFrom(Stamp{ns}), i);
    EXPECT_EQ(series.firstFrom(Stamp{ns + 1}), i + 1);
  }
  EXPECT_EQ(series.firstFrom(Stamp{-1}), 0U);
  EXPECT_EQ(series.firstFrom(Stamp{1'000'000}), kManyPoses);
}

TEST(PoseSeries, RowsAreSortedAndOfEqualStampsTheLastStays) {
  PoseSeries all, last;
  for (std::size_t i = 0; i < kManyPoses; ++i) {  // backward, two of each stamp
    const Stamp stamp{static_cast<std::int64_t>((kManyPoses - i) / 2)};
    all.add(stamp, placed(static_cast<double>(i)));
    last.add(stamp, placed(static_cast<double>(i)));
  }
  all.sort();
  last.sort(true);
  EXPECT_EQ(all.size(), kManyPoses);
  EXPECT_EQ(last.size(), kManyPoses / 2 + 1);
  for (std::size_t i = 1; i < all.size(); ++i)
    ASSERT_LE(all.row(i - 1).stamp, all.row(i).stamp) << i;
  for (std::size_t i = 1; i < last.size(); ++i)
    ASSERT_LT(last.row(i - 1).stamp, last.row(i).stamp) << i;
  // Stamp 1000 came with rows 2999 and 3000.
  EXPECT_EQ(last.row(last.firstFrom(Stamp{1000})).pose.translation().x(), 3000);
  EXPECT_EQ(all.row(all.firstFrom(Stamp{1000})).pose.translation().x(), 2999);
}

TEST(PoseSeries, WhatIsNotKeptIsForgotten) {
  PoseSeries series;
  for (int i = 0; i < 3000; ++i) series.add(Stamp{i}, placed(i));
  series.keep(2000, 2990);
  ASSERT_EQ(series.size(), 990U);
  EXPECT_EQ(series.row(0).stamp.ns, 2000);
  EXPECT_EQ(series.firstFrom(Stamp{2500}), 500U);
  series.keep(990, 990);
  EXPECT_TRUE(series.empty());
  series.add(Stamp{1}, placed(1));
  EXPECT_EQ(series.row(0).pose.translation().x(), 1);
}

}  // namespace
}  // namespace perception
