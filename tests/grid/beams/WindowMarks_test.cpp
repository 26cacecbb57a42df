#include "libperception/grid/beams/WindowMarks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "libperception/core/math/Random.h"

namespace perception {
namespace {

constexpr int kSideCells = 60, kLayers = 20;

GridParams smallWindow() {
  GridParams params;
  params.resolution = 0.2, params.size = 12;
  params.z_min = 0, params.z_max = 4, params.grade = 0;
  return params;
}

/// Cells that the beams of a scan cross in a smallWindow from the origin on.
template <class Mask>
std::set<int> crossedBy(WindowMarks<Mask>& marks, const GridScan& scan) {
  GridStats stats;
  marks.collect(scan, {0, 0, 0}, stats);
  std::set<int> cells;
  for (int column = 0; column < kSideCells * kSideCells; ++column) {
    for (int z = 0; z < kLayers; ++z)
      if (marks.crossed(static_cast<std::size_t>(column)) >> z & 1)
        cells.insert(column * kLayers + z);
    marks.reset(static_cast<std::size_t>(column));
  }
  return cells;
}

int indexOf(const Vector3& p) {
  const auto at = [](double v) { return static_cast<int>(std::floor(v / 0.2)); };
  if (p.minCoeff() < 0 || at(p.x()) >= kSideCells || at(p.y()) >= kSideCells ||
      at(p.z()) >= kLayers)
    return -1;
  return (at(p.y()) * kSideCells + at(p.x())) * kLayers + at(p.z());
}

/// Of the cells that a finely sampled beam is in, one that is not in `cells`; or -1.
int missing(const std::set<int>& cells, const Vector3& from, const Vector3& to) {
  for (double s = 0; s < 1; s += 1e-4) {
    const int cell = indexOf(from + s * (to - from));
    const auto deep = [&](double step) { return indexOf(from + (s + step) * (to - from)) == cell; };
    if (cell < 0 || cell == indexOf(to) || !deep(2e-4) || !deep(-2e-4)) continue;
    if (cells.count(cell) == 0) return cell;
  }
  return -1;
}

/// `out`: [m] by which the sensor may be beside the smallWindow of 12 m; negative: inside.
template <class Mask>
void expectEveryCellOfLoneBeams(double out) {
  WindowMarks<Mask> marks(smallWindow(), kLayers);
  Rng random({7, 0, 0, 1});
  for (int i = 0; i < 300; ++i) {
    GridScan scan;
    scan.T_world_ground.translation() = Vector3(6, 6, 0);
    scan.origin = {random.uniform(-out, 12 + out), random.uniform(-out, 12 + out),
                   random.uniform(0.1, 3.9)};
    // Ends within the smallWindow and outside, above and below it, too.
    const Vector3 end(random.uniform(-10, 22), random.uniform(-10, 22), random.uniform(-3, 7));
    scan.hits.push_back(end);
    const std::set<int> cells = crossedBy(marks, scan);
    EXPECT_EQ(missing(cells, scan.origin, end), -1) << "beam " << i;
    EXPECT_EQ(cells.count(indexOf(end)), 0U) << "the end itself is not crossed";
    const Vector3 d = (end - scan.origin).normalized();
    for (const int cell : cells) {
      const Vector3 center(cell / kLayers % kSideCells * 0.2 + 0.1,
                           cell / kLayers / kSideCells * 0.2 + 0.1, cell % kLayers * 0.2 + 0.1);
      EXPECT_LT((center - scan.origin).cross(d).norm(), 0.1 * std::sqrt(3.0) + 1e-3);
    }
  }
}

TEST(WindowMarks, ALoneBeamCrossesEveryCellOnItsWayAndNoOther) {
  expectEveryCellOfLoneBeams<std::uint32_t>(-2);
  expectEveryCellOfLoneBeams<std::uint64_t>(-2);
}

TEST(WindowMarks, ABeamOfASensorBesideTheWindowCrossesEveryCellOnItsWayAndNoOther) {
  expectEveryCellOfLoneBeams<std::uint32_t>(6);
  expectEveryCellOfLoneBeams<std::uint64_t>(6);
}

TEST(WindowMarks, BeamsThatShareTheirWayLeaveOutCornersAlone) {
  WindowMarks<std::uint32_t> together(smallWindow(), kLayers), alone(smallWindow(), kLayers);
  GridScan scan;
  scan.T_world_ground.translation() = Vector3(6, 6, 0);
  scan.origin = {6.01, 6.02, 1.73};
  Rng random({8, 0, 0, 1});
  for (int i = 0; i < 3000; ++i) {
    const double azimuth = random.uniform(0, kTwoPi), range = random.uniform(2, 9);
    const double up = random.uniform(-0.3, 0.1);
    scan.hits.push_back(scan.origin + range * Vector3(std::cos(azimuth), std::sin(azimuth), up));
  }
  std::set<int> all;
  GridScan one = scan;
  for (std::size_t i = 0; i < scan.hits.size(); ++i) {
    one.hits.clear(), one.hits.push_back(scan.hits[i]);
    for (const int cell : crossedBy(alone, one)) all.insert(cell);
  }
  for (std::size_t i = 0; i < scan.hits.size(); ++i) all.erase(indexOf(scan.hits[i]));
  std::set<int> cells = crossedBy(together, scan);
  for (std::size_t i = 0; i < scan.hits.size(); ++i) cells.erase(indexOf(scan.hits[i]));
  for (const int cell : cells) EXPECT_EQ(all.count(cell), 1U);
  EXPECT_GT(static_cast<double>(cells.size()), 0.97 * static_cast<double>(all.size()));
}

TEST(WindowMarks, ACellInDoubtTellsWhetherABeamWentThrough) {
  WindowMarks<std::uint32_t> marks(smallWindow(), kLayers);
  GridScan scan;
  scan.T_world_ground.translation() = Vector3(6, 6, 0);
  scan.origin = {6.1, 6.1, 1.7};
  scan.hits.emplace_back(9.1, 6.1, 1.7), scan.hits.emplace_back(10.1, 6.1, 1.7);
  scan.weights = {0.2F, 0.3F};
  GridStats stats;
  marks.collect(scan, {0, 0, 0}, stats);
  ASSERT_EQ(marks.doubts().size(), 2U);
  EXPECT_TRUE(marks.doubts()[0].crossed) << "by the beam behind it";
  EXPECT_FALSE(marks.doubts()[1].crossed);
  EXPECT_EQ(marks.crossed(marks.doubts()[0].column) >> marks.doubts()[0].layer & 1, 0U);
}

/// `count` doubted hits in the middle of a smallWindow: what remains of them.
void expectLargestWeights(int count) {
  WindowMarks<std::uint32_t> marks(smallWindow(), kLayers);
  Rng random({8, 0, 0, 1});
  GridScan scan;
  scan.T_world_ground.translation() = Vector3(6, 6, 0);
  scan.origin = {6, 6, 2};
  std::map<int, float> largest;  // by cell
  for (int i = 0; i < count; ++i) {
    const auto among = [&](unsigned first, unsigned cells) {
      return (first + random.below(cells)) * 0.2 + 0.1;
    };
    const Vector3 place(among(20, 20), among(20, 20), among(5, 10));
    const auto weight = static_cast<float>(random.uniform(0.1, 0.9));
    scan.hits.push_back(place), scan.weights.push_back(weight);
    float& most = largest[indexOf(place)];
    most = std::max(most, weight);
  }
  GridStats stats;
  marks.collect(scan, {0, 0, 0}, stats);
  std::vector<std::pair<int, float>> found;
  for (const auto& doubt : marks.doubts())
    found.emplace_back(static_cast<int>(doubt.column) * kLayers + doubt.layer, doubt.weight);
  const std::vector<std::pair<int, float>> expected(largest.begin(), largest.end());
  EXPECT_EQ(found, expected);
}

TEST(WindowMarks, OfDoubtedHitsTheLargestWeightOfACellRemainsInTheOrderOfCells) {
  expectLargestWeights(20);
  expectLargestWeights(5000);
}

}  // namespace
}  // namespace perception
