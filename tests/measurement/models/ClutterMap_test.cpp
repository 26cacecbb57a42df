#include "libperception/measurement/models/ClutterMap.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/core/math/Random.h"

namespace perception {
namespace {

DetectionParams view(double clutter_per_scan) {
  DetectionParams p;
  p.clutter_per_scan = clutter_per_scan;
  p.range_max = 70;
  p.fov = radians(120);
  return p;
}

/// `seconds` of scans at 10 Hz with Poisson clutter of `rate` a scan in the view, uniform by area.
void observe(double rate, double seconds, ClutterMap& map) {
  Rng rng({1, 0, 0, 0});
  for (int scan = 0; scan < 10 * seconds; ++scan) {
    std::vector<double> clutter(map.cells().size(), 0);
    for (std::size_t c = 0; c < clutter.size(); ++c)
      clutter[c] = rng.poisson(rate * map.cells().share(c));
    map.add(clutter, scan > 0 ? 0.1 : 0);
  }
}

TEST(ViewCells, ShareTheWholeViewAndHoldEveryPlaceInIt) {
  for (const double fov : {15.0, 120.0, 360.0}) {
    DetectionParams p = view(1);
    p.fov = radians(fov), p.range_min = 2;
    const ViewCells cells(p);
    double sum = 0;
    for (std::size_t c = 0; c < cells.size(); ++c) sum += cells.share(c);
    EXPECT_NEAR(sum, 1, 1e-12);
    std::vector<int> hits(cells.size(), 0);
    for (double range = 2; range < 70; range += 1)
      for (double b = -fov / 2 + 0.5; b < fov / 2; b += 1) ++hits[cells.at(range, radians(b))];
    for (const int n : hits) EXPECT_GT(n, 0) << fov;
    EXPECT_LT(cells.at(500, radians(400)), cells.size());
  }
}

TEST(ClutterMap, IsTheConfiguredRateBeforeAnyScan) {
  const ClutterMap map(view(2));
  EXPECT_DOUBLE_EQ(map.rate(), 2);
  for (std::size_t c = 0; c < map.cells().size(); ++c) EXPECT_DOUBLE_EQ(map.logFactor(c), 0);
}

TEST(ClutterMap, ARateMissetByTenEitherWayIsFoundInTwentySeconds) {
  for (const double configured : {0.2, 2.0, 20.0}) {
    ClutterMap map(view(configured));
    observe(2, 20, map);
    EXPECT_NEAR(map.rate(), 2, 0.3) << configured;
    for (std::size_t c = 0; c < map.cells().size(); ++c)
      EXPECT_NEAR(std::exp(map.logFactor(c)) * configured, 2, 1.2) << configured;
  }
}

TEST(ClutterMap, RatesMissetByTenEndWithinFivePercentOfEachOther) {
  for (const double rate : {0.3, 3.0}) {
    ClutterMap right(view(rate));
    observe(rate, 20, right);
    for (const double factor : {0.1, 10.0}) {
      ClutterMap wrong(view(factor * rate));
      observe(rate, 20, wrong);
      EXPECT_NEAR(wrong.rate() / right.rate(), 1, 0.05) << rate << " " << factor;
    }
  }
}

TEST(ClutterMap, ADenseCellIsFoundHoweverLowTheConfiguredRate) {
  ClutterMap low(view(0.02)), right(view(2));
  for (int scan = 0; scan < 200; ++scan) {
    std::vector<double> clutter(low.cells().size(), 0);
    clutter[0] = 2;
    low.add(clutter, 0.1), right.add(clutter, 0.1);
  }
  EXPECT_NEAR(low.logFactor(0) + std::log(0.02), right.logFactor(0) + std::log(2), std::log(1.2));
}

TEST(ClutterMap, TellsWhereInTheViewItIs) {
  ClutterMap map(view(1));
  const std::size_t loud = map.cells().at(15, radians(40)),
                    quiet = map.cells().at(15, radians(-40));
  for (int scan = 0; scan < 200; ++scan) {
    std::vector<double> clutter(map.cells().size(), 0);
    clutter[loud] = 1;
    map.add(clutter, 0.1);
  }
  EXPECT_GT(map.logFactor(loud), std::log(5));
  EXPECT_LT(map.logFactor(quiet), 0);
}

TEST(ClutterMap, ForgetsTheRainThatIsOver) {
  ClutterMap map(view(1));
  observe(30, 20, map);
  EXPECT_GT(map.rate(), 20);
  observe(0, 60, map);
  EXPECT_LT(map.rate(), 0.2);
}

TEST(ClutterMap, SilenceIsUnlikelyOnlyWhereClutterIsUsual) {
  ClutterMap loud(view(0.3)), quiet(view(0.3));
  observe(0.3, 20, loud), observe(0, 20, quiet);
  EXPECT_LT(loud.logSilence(60), -9);
  EXPECT_GT(quiet.logSilence(60), -1);
  EXPECT_GT(loud.logSilence(5), -2.5);
}

}  // namespace
}  // namespace perception
