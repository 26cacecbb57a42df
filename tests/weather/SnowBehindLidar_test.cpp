// What point trust is worth in the safety grid and in clusters, in real snow; snow_study prints the
// tables.
#include <gtest/gtest.h>

#include "tests/support/SnowRun.h"

namespace perception {
namespace {

class InRealSnow : public testing::Test {
 protected:
  void SetUp() override {
    const auto scans =
        test::labeledScans(std::string(PERCEPTION_SHARED_DATA) + "/data/wads_snow", 2.17, 8);
    if (scans.empty()) GTEST_SKIP() << "no wads_snow";
    WeatherParams weather;
    weather.filter = "trust";
    GridParams grid;
    grid.back_end = GridParams::BackEnd::kRolling;
    sum_ = test::compareInSnow(scans, weather, grid);
  }
  test::SnowComparison sum_;
};

TEST_F(InRealSnow, GridKeepsCarsAndPersonsAndForgetsSnow) {
  EXPECT_GT(sum_.plain_cells, 1000);
  EXPECT_GT(sum_.fewer(), 20);
  EXPECT_GT(sum_.user_cells, 1000);
  EXPECT_GT(sum_.cleanKept(), 0.995) << "cells that snow had not helped to mark";
  EXPECT_GT(sum_.kept(), 0.995);
  EXPECT_LT(sum_.trusted_clusters, 0.3 * sum_.plain_clusters);
}

}  // namespace
}  // namespace perception
