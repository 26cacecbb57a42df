#include "libperception/grid/SafetyGrid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "libperception/config/Config.h"
#include "libperception/core/Error.h"
#include "libperception/core/math/Random.h"

namespace perception {
namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kPeriod = 0.1;  // [s] of a lidar

/// A scan from a roof lidar at (x, y) that sees flat ground out to 35 m.
GridScan scanAt(double t, double x = 0, double y = 0) {
  GridScan scan;
  scan.stamp = Stamp::fromSeconds(1000 + t);
  scan.T_world_ground = makePose(x, y, 0, 0);
  scan.origin = Vector3(x, y, 1.73);
  return scan;
}

/// The lidar's beams against a wall across the road `wall` meters ahead (none: infinity), 8 m wide
/// and 2 m high, and the ground.
GridScan sceneWithWall(double t, double wall, double x = 0, double step_deg = 0.5) {
  GridScan scan = scanAt(t, x);
  for (double azimuth = -180; azimuth < 180; azimuth += step_deg) {
    for (int beam = 0; beam < 40; ++beam) {
      const double a = radians(azimuth), e = radians(-24.8 + beam * 0.7);
      const Vector3 d(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
      const double to_ground = d.z() < 0 ? -1.73 / d.z() : 1e9;
      const double to_wall = d.x() > 0 ? wall / d.x() : 1e9;
      const Vector3 at_wall = scan.origin + to_wall * d;
      const bool hit = to_wall < to_ground && std::abs(at_wall.y()) < 4 && at_wall.z() < 2;
      if (hit) {
        (at_wall.z() > 0.3 ? scan.hits : scan.clear).push_back(at_wall);
      } else {
        scan.clear.push_back(scan.origin + std::min(to_ground, 50.0) * d);
      }
    }
  }
  return scan;
}

class SafetyGridContract : public testing::TestWithParam<GridParams::BackEnd> {
 protected:
  static GridParams smallWindow() {
    GridParams params;
    params.size = 64;         // [m] what stands up to 30 m away is enough
    params.resolution = 0.4;  // [m] a few seconds for all back ends
    return params;
  }
  std::unique_ptr<SafetyGrid> grid(GridParams params = smallWindow()) const {
    params.back_end = GetParam();
    return makeSafetyGrid(params);
  }
};

TEST_P(SafetyGridContract, WallStopsTheFreeDistanceAtItsRange) {
  const auto g = grid();
  for (int i = 0; i < 3; ++i) g->insert(sceneWithWall(i * kPeriod, 20));
  const FreeDistance ahead = g->freeDistance({});
  EXPECT_TRUE(ahead.blocked);
  EXPECT_NEAR(ahead.distance, 20, g->params().resolution + 1e-9);
  EXPECT_GT(ahead.seen, 17);
  Corridor beside;
  beside.T_world_ego = makePose(0, 8, 0, 0);
  EXPECT_FALSE(g->freeDistance(beside).blocked);
}

TEST_P(SafetyGridContract, OneScanDoesNotMakeAnObstacle) {
  const auto g = grid();
  g->insert(sceneWithWall(0, 20));
  EXPECT_TRUE(g->occupiedCells().empty());
}

TEST_P(SafetyGridContract, SteeringLeadsPastAnObstacleAhead) {
  const auto g = grid();
  for (int i = 0; i < 3; ++i) g->insert(sceneWithWall(i * kPeriod, 20));
  Corridor turn;
  turn.curvature = 1.0 / 12;  // left, out of the wall's way: at most 12 m ahead
  turn.max = 18;
  EXPECT_FALSE(g->freeDistance(turn).blocked);
  EXPECT_DOUBLE_EQ(g->freeDistance(turn).distance, 18);
}

TEST_P(SafetyGridContract, CellsOfAnObjectThatHasLeftAreCleared) {
  const auto g = grid();
  for (int i = 0; i < 10; ++i) g->insert(sceneWithWall(i * kPeriod, 12));
  ASSERT_TRUE(g->freeDistance({}).blocked);
  for (int i = 10; i < 18; ++i) g->insert(sceneWithWall(i * kPeriod, 25));
  const FreeDistance ahead = g->freeDistance({});
  EXPECT_NEAR(ahead.distance, 25, g->params().resolution + 1e-9)
      << "0.8 s are far below the 4.2 s in which the cells would decay by themselves";
}

TEST_P(SafetyGridContract, CellsDecayWithTau) {
  const auto g = grid();
  for (int i = 0; i < 10; ++i) g->insert(sceneWithWall(i * kPeriod, 20));
  const Vector3 place(20.05, 0.05, 1.05);
  const double before = g->logOdds(place);
  ASSERT_NEAR(before, g->params().high, 0.1);
  // Scans that see nothing: only time passes.
  for (int i = 1; i <= 10; ++i) g->insert(scanAt(0.9 + i * 0.5));
  EXPECT_NEAR(g->logOdds(place), before * std::exp(-1), 0.15);
  EXPECT_FALSE(g->isOccupied(place));
}

TEST_P(SafetyGridContract, ThinPhantomsOfLowWeightDoNotBlock) {
  const auto g = grid();
  Rng random({1, 0, 0, 0});
  for (int i = 0; i < 10; ++i) {
    GridScan scan = sceneWithWall(i * kPeriod, 30);
    scan.weights.assign(scan.hits.size(), 1.0F);
    for (int flake = 0; flake < 400; ++flake) {  // snow around the vehicle
      scan.hits.emplace_back(random.uniform(2, 15), random.uniform(-5, 5), random.uniform(0.3, 2));
      scan.weights.push_back(0.1F);
    }
    g->insert(scan);
  }
  EXPECT_NEAR(g->freeDistance({}).distance, 30, g->params().resolution + 1e-9);
}

TEST_P(SafetyGridContract, TheSameReturnsWithFullWeightBlock) {
  const auto g = grid();
  GridScan scan = sceneWithWall(0, 30);
  for (int i = 0; i < 3; ++i) {
    scan.stamp = scan.stamp + kPeriod;
    scan.hits.emplace_back(8, 0, 1);
    g->insert(scan);
  }
  EXPECT_NEAR(g->freeDistance({}).distance, 8, g->params().resolution + 1e-9);
}

TEST_P(SafetyGridContract, TwoTrustedScansMarkWhatDrivesIntoFreeSpace) {
  const auto judged = grid(), unjudged = grid();
  for (int i = 0; i < 22; ++i) {
    GridScan scan = sceneWithWall(i * kPeriod, i < 20 ? 30 : 12);
    unjudged->insert(scan);
    scan.weights.assign(scan.hits.size(), 1.0F);
    judged->insert(scan);
  }
  int places = 0, marked = 0, before = 0;
  for (double y = -3; y <= 3; y += 0.4) {
    const Vector3 place(12.05, y, 1.05);
    ++places, marked += judged->isOccupied(place), before += unjudged->isOccupied(place);
  }
  EXPECT_EQ(marked, places);
  EXPECT_LT(before, places / 2) << "two flakes in a place would block as well";
}

TEST_P(SafetyGridContract, CellsOfAnAreaAreThoseOfAllWithTheirCentersInIt) {
  const auto g = grid();
  for (int k = 0; k < 4; ++k) g->insert(sceneWithWall(k * kPeriod, 20));
  const GridArea area{19, 21, -2.3, 1.1};
  std::vector<Vector3> wanted, found;
  for (const GridCell& cell : g->occupiedCells())
    if (area.holds(cell.center)) wanted.push_back(cell.center);
  for (const GridCell& cell : g->occupiedWithin(area)) found.push_back(cell.center);
  EXPECT_GT(found.size(), 5u);
  EXPECT_LT(found.size(), g->occupiedCells().size());
  EXPECT_EQ(found, wanted);
}

TEST_P(SafetyGridContract, EmptyScansAreHarmless) {
  const auto g = grid();
  EXPECT_TRUE(g->occupiedCells().empty());
  const GridStats stats = g->insert(scanAt(0));
  EXPECT_EQ(stats.hits + stats.rays + stats.not_finite, 0U);
  const FreeDistance ahead = g->freeDistance({});
  EXPECT_FALSE(ahead.blocked);
  EXPECT_DOUBLE_EQ(ahead.seen, Corridor{}.from)
      << "nothing was seen, so nothing is known to be free";
}

TEST_P(SafetyGridContract, PointsThatAreNoNumbersAreCountedAndIgnored) {
  const auto clean = grid(), dirty = grid();
  for (int i = 0; i < 3; ++i) {
    GridScan scan = sceneWithWall(i * kPeriod, 20);
    clean->insert(scan);
    scan.hits.emplace_back(kNotANumber, 1, 1);
    scan.hits.emplace_back(1, std::numeric_limits<double>::infinity(), 1);
    scan.clear.emplace_back(1, 2, kNotANumber);
    EXPECT_EQ(dirty->insert(scan).not_finite, 3U);
  }
  const auto a = clean->occupiedCells(), b = dirty->occupiedCells();
  ASSERT_EQ(a.size(), b.size());
  ASSERT_FALSE(a.empty());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].center, b[i].center);
}

TEST_P(SafetyGridContract, ALateScanIsReportedAndTakenAtTheLastTime) {
  const auto g = grid();
  for (int i = 0; i < 3; ++i) g->insert(sceneWithWall(i * kPeriod, 20));
  EXPECT_TRUE(g->insert(sceneWithWall(-5, 20)).late);
  EXPECT_TRUE(g->isOccupied({20.05, 0.05, 1.05}));
}

TEST_P(SafetyGridContract, WorldFarFromItsOriginChangesNothing) {
  const auto g = grid();
  const Vector3 far(512000, 5402000, 300);  // UTM
  for (int i = 0; i < 3; ++i) {
    GridScan scan = sceneWithWall(i * kPeriod, 20);
    scan.hits.shift(far), scan.clear.shift(far);
    scan.origin += far;
    scan.T_world_ground.translation() += far;
    g->insert(scan);
  }
  Corridor corridor;
  corridor.T_world_ego.translation() = far;
  EXPECT_NEAR(g->freeDistance(corridor).distance, 20, g->params().resolution + 1e-6);
}

TEST_P(SafetyGridContract, WindowMovesWithTheVehicleAndForgetsWhatIsOutside) {
  const auto g = grid();
  for (int i = 0; i < 5; ++i) g->insert(sceneWithWall(i * kPeriod, 20));
  const Vector3 wall(20.05, 0.05, 1.05);
  g->insert(scanAt(0.5, 10));
  EXPECT_TRUE(g->isOccupied(wall)) << "inside the window, at its place in the world";
  g->insert(scanAt(0.6, 70));
  EXPECT_FALSE(g->isOccupied(wall));
  EXPECT_TRUE(g->occupiedCells().empty());
}

TEST_P(SafetyGridContract, MemoryStaysFlatWhileTheVehicleDrives) {
  GridParams params;
  params.resolution = 0.5;
  params.size = 30;
  const auto g = grid(params);
  const auto drive = [&](int begin, int end) {
    std::size_t most = 0;
    for (int i = begin; i < end; ++i) {
      // 180 m a scan: a wall, the ground, and 36 km in the end, beyond the keys of one octree.
      g->insert(sceneWithWall(i * 1.0, 15, i * 180.0, 3));
      most = std::max(most, g->memoryBytes());
    }
    return most;
  };
  const std::size_t early = drive(0, 25);
  const std::size_t late = drive(25, 200);
  EXPECT_LE(static_cast<double>(late), 1.1 * static_cast<double>(early));
}

std::string nameOf(const testing::TestParamInfo<GridParams::BackEnd>& info) {
  static const char* const kNames[] = {"octomap", "mrpt2d", "rolling", "rolling2d"};
  return kNames[static_cast<std::size_t>(info.param)];
}

INSTANTIATE_TEST_SUITE_P(BackEnds, SafetyGridContract,
                         testing::Values(GridParams::BackEnd::kOctomap,
                                         GridParams::BackEnd::kMrpt2d,
                                         GridParams::BackEnd::kRolling,
                                         GridParams::BackEnd::kRolling2d),
                         nameOf);

/// Back ends whose cells stand in space.
class SpaceGrid : public SafetyGridContract {};

TEST_P(SpaceGrid, BridgeDoesNotBlockTheRoadBelow) {
  const auto g = grid();
  for (int i = 0; i < 5; ++i) {
    GridScan scan = sceneWithWall(i * kPeriod, 30);
    for (double y = -5; y < 5; y += 0.1) scan.hits.emplace_back(15, y, 4.5);
    g->insert(scan);
  }
  EXPECT_NEAR(g->freeDistance({}).distance, 30, g->params().resolution + 1e-9);
}

INSTANTIATE_TEST_SUITE_P(BackEnds, SpaceGrid,
                         testing::Values(GridParams::BackEnd::kOctomap,
                                         GridParams::BackEnd::kRolling),
                         nameOf);

/// Simulated: the vehicle drives through a street with posts, phantoms of some weight, and a bar
/// that stands in the way for a while. Free distance, and to where it was seen, after each scan.
std::vector<FreeDistance> driveThroughAStreet(GridParams::BackEnd back_end) {
  GridParams params;
  params.back_end = back_end;
  params.size = 64, params.resolution = 0.4;
  const auto grid = makeSafetyGrid(params);
  Rng random({7, 0, 0, 1});
  std::vector<FreeDistance> found;
  for (int i = 0; i < 40; ++i) {
    GridScan scan = sceneWithWall(i * kPeriod, 45 - i, i, 1);
    scan.weights.assign(scan.hits.size(), 1.F);
    const auto add = [&](double x, double y, double z, float weight) {
      scan.hits.emplace_back(x, y, z), scan.weights.push_back(weight);
    };
    for (int post = 0; post < 10; ++post)
      for (double z = 0.4; z < 1.5; z += 0.1) add(8. * post, post % 2 ? 2.5 : -2.5, z, 1);
    for (int k = 0; k < 60; ++k)  // phantoms
      add(i + random.uniform(3, 30), random.uniform(-3, 3), random.uniform(0.5, 2), 0.2F);
    if (i > 10 && i < 25)
      for (double y = -1; y < 1; y += 0.1) add(35, y, 0.9, 1);
    grid->insert(scan);
    Corridor corridor;
    corridor.T_world_ego = scan.T_world_ground;
    corridor.max = 28, corridor.cells = 3;
    found.push_back(grid->freeDistance(corridor));
  }
  return found;
}

TEST(SafetyGrid, TheStoresOfOneGridAnswerAlike) {
  using BackEnd = GridParams::BackEnd;
  const std::pair<BackEnd, BackEnd> kPairs[] = {{BackEnd::kOctomap, BackEnd::kRolling},
                                                {BackEnd::kMrpt2d, BackEnd::kRolling2d}};
  for (const auto& [store, fast] : kPairs) {
    const auto a = driveThroughAStreet(store), b = driveThroughAStreet(fast);
    std::size_t blocked = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_EQ(a[i].blocked, b[i].blocked) << "scan " << i;
      EXPECT_NEAR(a[i].distance, b[i].distance, 0.4 + 1e-9) << "scan " << i;
      EXPECT_NEAR(a[i].seen, b[i].seen, 0.4 + 1e-9) << "scan " << i;
      blocked += a[i].blocked;
    }
    EXPECT_GT(blocked, 5u) << "the bar is found";
    EXPECT_LT(blocked, a.size() - 5) << "and forgotten";
  }
}

TEST(GridParams, UnknownBackEndIsAConfigurationFault) {
  Config config = Config::fromText("[grid]\nback_end = balltree\n");
  config.read<GridParams>("grid");
  EXPECT_THROW(config.finish(), ConfigError);
}

}  // namespace
}  // namespace perception
