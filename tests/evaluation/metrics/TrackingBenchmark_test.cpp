#include "libperception/evaluation/metrics/TrackingBenchmark.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/CommandOutput.h"
#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

/// Ten frames of one object that drives, found by the tracks of the given ids.
std::vector<BenchmarkFrame> oneObject(const std::vector<std::int64_t>& tracks, double off = 0.5) {
  std::vector<BenchmarkFrame> frames;
  for (std::size_t k = 0; k < tracks.size(); ++k) {
    BenchmarkFrame frame;
    const double x = static_cast<double>(k);
    frame.truth.push_back({7, {x, 0}, 0});
    if (tracks[k] >= 0) frame.tracks.push_back({tracks[k], {x, off}, 0.9});
    frames.push_back(frame);
  }
  return frames;
}

TEST(TrackingBenchmark, ATrackFromBeginningToEndIsPerfectUpToItsError) {
  const auto figures = trackingBenchmark(oneObject(std::vector<std::int64_t>(10, 3)));
  EXPECT_NEAR(figures.amota, 1, 1e-12);
  EXPECT_NEAR(figures.amotp, 0.5, 1e-12);
  EXPECT_EQ(figures.recall, 1);
}

TEST(TrackingBenchmark, RecallsThatAreNotReachedCountNothingAndTwoMeters) {
  const auto figures = trackingBenchmark(oneObject({3, 3, 3, 3, 3, -1, -1, -1, -1, -1}));
  // Of the 40 recalls from 0.1 to 1 those up to 0.5 are reached: 18.
  EXPECT_NEAR(figures.amota, 18 / 40.0, 1e-12);
  EXPECT_NEAR(figures.amotp, (18 * 0.5 + 22 * 2) / 40, 1e-12);
  EXPECT_EQ(figures.recall, 0.5);
}

TEST(TrackingBenchmark, AChangeOfIdentityCostsOneFault) {
  const auto figures = trackingBenchmark(oneObject({3, 3, 3, 3, 3, 4, 4, 4, 4, 4}));
  EXPECT_EQ(figures.switches, 1U);
  EXPECT_NEAR(figures.amota, 0.9, 1e-12);
}

TEST(TrackingBenchmark, ATrackTwoMetersAwayIsFalse) {
  const auto figures = trackingBenchmark(oneObject(std::vector<std::int64_t>(10, 3), 2));
  EXPECT_EQ(figures.false_boxes, 10U);
  EXPECT_EQ(figures.amota, 0);
  EXPECT_NEAR(figures.amotp, 2, 1e-12);
}

TEST(TrackingBenchmark, FalseTracksOfLowScoreCostOnlyTheRecallsThatNeedThem) {
  auto frames = oneObject({3, 3, 3, 3, 3, 4, 4, 4, 4, 4});
  for (std::size_t k = 0; k < frames.size(); ++k) {
    frames[k].tracks[0].score = k < 5 ? 0.9 : 0.2;
    frames[k].tracks.push_back({9, {100, 100}, 0.5});
  }
  const auto figures = trackingBenchmark(frames);
  EXPECT_GT(figures.amota, 0.4);
  EXPECT_LT(figures.amota, 0.6);
}

TEST(TrackingBenchmark, NamesAreThoseOfTheBenchmark) {
  EXPECT_EQ(benchmarkNameOf("Van"), "car");
  EXPECT_EQ(benchmarkNameOf("Cyclist"), "bicycle");
  EXPECT_EQ(benchmarkNameOf("DontCare"), "");
  EXPECT_EQ(benchmarkNameOf("bus", 7), "truck");
  EXPECT_EQ(benchmarkNameOf("bus", 12), "bus");
  EXPECT_EQ(benchmarkNameOf("static-other", 1), "");
}

/// Objects that drive and tracks of them with gaps, changed identities and false ones.
std::vector<BenchmarkFrame> randomCase(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(0, 1);
  std::normal_distribution<double> noise(0, 0.7);
  std::vector<BenchmarkFrame> frames(25);
  const int objects = 3 + static_cast<int>(seed % 7);
  std::int64_t id = 100;
  for (int o = 0; o < objects; ++o) {
    const double x = 30 * any(random), y = 30 * any(random), vx = 2 * any(random) - 1;
    std::int64_t track = ++id;
    const double score = any(random);
    for (std::size_t k = 0; k < frames.size(); ++k) {
      if (any(random) < 0.1) continue;
      const Vector2 at(x + vx * static_cast<double>(k), y);
      frames[k].truth.push_back({o, at, 0});
      if (any(random) < 0.05) track = ++id;
      if (any(random) < 0.25) continue;
      frames[k].tracks.push_back(
          {track, at + Vector2(noise(random), noise(random)), score + 0.1 * any(random)});
    }
  }
  for (int f = 0; f < 4; ++f) {
    ++id;
    const double x = 30 * any(random), y = 30 * any(random), score = any(random);
    for (std::size_t k = 0; k < frames.size(); ++k)
      if (any(random) < 0.4) frames[k].tracks.push_back({id, {x, y}, score});
  }
  return frames;
}

TEST(TrackingBenchmark, AgreesWithAnIndependentImplementationInTwentyRandomCases) {
  if (test::outputOf({"/usr/bin/python3", "-c", "import numpy, scipy"}).code != 0)
    GTEST_SKIP() << "no numpy and scipy";
  const test::TemporaryFolder folder;
  std::vector<std::string> words = {
      "/usr/bin/python3", PERCEPTION_SOURCE_DIR "/tests/bench/kitti/tracking_benchmark.py"};
  for (unsigned seed = 0; seed < 20; ++seed) {
    const std::string path = folder / fmt::format("{}.csv", seed);
    std::ofstream file(path);
    const auto frames = randomCase(seed);
    for (std::size_t k = 0; k < frames.size(); ++k) {
      for (const auto& [kind, boxes] : {std::pair(0, &frames[k].truth), {1, &frames[k].tracks}})
        for (const BenchmarkBox& b : *boxes)
          file << fmt::format("{},{},{},{},{},{}\n", k, kind, b.id, b.center.x(), b.center.y(),
                              b.score);
    }
    words.push_back(path);
  }
  const auto [code, text] = test::outputOf(words);
  ASSERT_EQ(code, 0) << text;
  std::istringstream lines(text);
  int good = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    double amota = 0, amotp = 0, recall = 0;
    std::size_t switches = 0, false_boxes = 0;
    ASSERT_TRUE(lines >> amota >> amotp >> recall >> switches >> false_boxes);
    const auto figures = trackingBenchmark(randomCase(seed));
    good += amota > 0.1;
    EXPECT_NEAR(figures.amota, amota, 1e-6);
    EXPECT_NEAR(figures.amotp, amotp, 1e-6);
    EXPECT_NEAR(figures.recall, recall, 1e-9);
    EXPECT_EQ(figures.switches, switches);
    EXPECT_EQ(figures.false_boxes, false_boxes);
  }
  EXPECT_GT(good, 10) << "cases that tell something";
}

}  // namespace
}  // namespace perception
