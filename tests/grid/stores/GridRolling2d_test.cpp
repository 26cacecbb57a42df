#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "libperception/core/math/Random.h"
#include "libperception/grid/SafetyGrid.h"

// What a scan says of the ground, told plainly: return by return, beam by beam, cell by cell.
namespace perception {
namespace {

using Cell = std::pair<int, int>;

constexpr double kEdge = 20, kCell = 0.2, kStep = 1;  // [m], [m], [deg]
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

GridParams window() {
  GridParams params;
  params.back_end = GridParams::BackEnd::kRolling2d;
  params.size = kEdge, params.resolution = kCell, params.ray_step = radians(kStep);
  return params;
}

Cell cellOf(const Vector3& p) {
  return {static_cast<int>(std::floor(p.x() / kCell)), static_cast<int>(std::floor(p.y() / kCell))};
}

int bearingOf(const GridScan& scan, const Vector3& p) {
  const Vector3 d = p - scan.origin;
  return static_cast<int>(degrees(std::atan2(d.y(), d.x()) + kPi) / kStep);
}

/// Whether no rounding can move a point into another cell, bearing or out of the slab.
bool isClearCut(const GridScan& scan, const Vector3& p) {
  const auto inside = [](double v) { return std::abs(v - std::round(v)) > 0.01; };
  const Vector3 d = p - scan.origin;
  const double turn = degrees(std::atan2(d.y(), d.x()) + kPi) / kStep;
  const double wider = window().grade * (p - scan.T_world_ground.translation()).head<2>().norm();
  return inside(p.x() / kCell) && inside(p.y() / kCell) &&
         std::abs(turn - std::round(turn)) > 0.05 && d.head<2>().norm() > 2 * kCell &&
         std::min(std::abs(p.z() - window().z_min + wider),
                  std::abs(p.z() - window().z_max - wider)) > 1e-3;
}

/// In the quadrant of bearings that begins at `turn` times 90 degrees, up to `reach` [m].
Vector3 randomPoint(Rng& random, const GridScan& scan, double turn, double reach) {
  Vector3 p;
  do {
    const double azimuth = (turn + random.uniform(0, 1)) * kPi / 2;
    const double range = random.uniform(0.5, reach);
    p = scan.origin + range * Vector3(std::cos(azimuth), std::sin(azimuth), 0);
    p.z() = random.uniform(-1.5, 5);
  } while (!isClearCut(scan, p));
  return p;
}

float randomWeight(Rng& random) {
  const double kind = random.uniform(0, 1);
  if (kind < 0.5) return 1;
  if (kind < 0.55) return kNan;
  if (kind < 0.6) return 0;
  return static_cast<float>(random.uniform(0, 1));
}

/// Hits at some bearings, then points that only clear: quadrant by quadrant, each seen up to
/// another range, the far ones first, as a lidar's rings are.
GridScan randomScan(std::uint64_t seed, bool weighted) {
  Rng random({seed, 0, 0, 1});
  GridScan scan;
  scan.stamp = Stamp::fromSeconds(1000);
  scan.T_world_ground.translation() = Vector3(random.uniform(-50, 50), random.uniform(-50, 50), 0);
  scan.origin = scan.T_world_ground.translation() +
                Vector3(random.uniform(-2, 2), random.uniform(-2, 2), 1.73);
  while (scan.hits.size() < 3000) {
    const Vector3 p = randomPoint(random, scan, random.uniform(0, 4), 14), d = p - scan.origin;
    if (std::sin(5 * std::atan2(d.y(), d.x())) > 0 && d.norm() > 4) scan.hits.push_back(p);
  }
  for (int i = 0; i < 4; ++i) {
    const auto quadrant =
        static_cast<double>((seed + static_cast<std::uint64_t>(i) * (1 + 2 * (seed % 2))) % 4);
    for (double reach = 16 - 3 * i; reach > 2; reach *= 0.8)
      for (int k = 0; k < 700; ++k)
        scan.clear.push_back(randomPoint(random, scan, quadrant, reach));
  }
  for (GridPoints* points : {&scan.hits, &scan.clear}) {
    points->emplace_back(static_cast<double>(kNan), 1, 1);
    points->emplace_back(scan.origin.x() + 3, scan.origin.y(), static_cast<double>(kNan));
    points->push_back(scan.origin);
  }
  if (weighted)
    for (std::size_t i = 0; i < scan.hits.size(); ++i) scan.weights.push_back(randomWeight(random));
  return scan;
}

/// What a scan says.
struct Plain {
  std::map<Cell, double> weights;  ///< greatest of each cell's hits, in steps of 1/255
  std::map<int, Vector3> ends;     ///< of each bearing's beam
};

bool inSlab(const GridScan& scan, const Vector3& p) {
  const GridParams params = window();
  const double wider = params.grade * (p - scan.T_world_ground.translation()).head<2>().norm();
  return p.z() >= params.z_min - wider && p.z() <= params.z_max + wider;
}

Plain plainly(const GridScan& scan) {
  Plain out;
  std::map<int, double> nearest, farthest;
  const auto offer = [&](const Vector3& p, bool stops) {
    const double range = (p - scan.origin).head<2>().norm();
    if (!p.allFinite() || range <= kCell) return;
    const int bearing = bearingOf(scan, p);
    if (stops && (nearest.count(bearing) == 0 || range < nearest[bearing]))
      nearest[bearing] = range, out.ends[bearing] = p;
    if (!stops && nearest.count(bearing) == 0 && range > farthest[bearing])
      farthest[bearing] = range, out.ends[bearing] = p;
  };
  for (std::size_t i = 0; i < scan.hits.size(); ++i) {
    const Vector3 p = scan.hits[i];
    const float given = scan.weights.empty() ? 1 : scan.weights[i];
    const double w = given < 0.99F ? std::max(0.0, static_cast<double>(given)) : 1;
    offer(p, inSlab(scan, p) && w >= 0.5);
    if (p.allFinite() && inSlab(scan, p)) {
      double& weight = out.weights[cellOf(p)];
      weight = std::max(weight, std::floor(w * 255 + 0.5) / 255);
    }
  }
  for (std::size_t i = 0; i < scan.clear.size(); ++i) offer(scan.clear[i], false);
  return out;
}

/// The cells that beams cross but for their last ones: those that they are deep in, and all that
/// they may be in whatever the rounding.
struct Crossed {
  std::set<Cell> surely, maybe;
};

Crossed crossedBy(const GridScan& scan, const Plain& plain) {
  constexpr double kBand = 1e-4;  // [cells]
  Crossed out;
  for (const auto& [bearing, end] : plain.ends) {
    const Vector3 d = end - scan.origin;
    const Cell last = cellOf(end);
    const double step = 0.002 / d.head<2>().norm();
    for (double s = 0; s < 1; s += step) {
      const Vector3 p = scan.origin + s * d;
      if (cellOf(p) == last) break;
      const double x = p.x() / kCell, y = p.y() / kCell;
      std::set<Cell> around;
      for (const double dx : {-kBand, kBand})
        for (const double dy : {-kBand, kBand})
          around.insert(
              {static_cast<int>(std::floor(x + dx)), static_cast<int>(std::floor(y + dy))});
      out.maybe.insert(around.begin(), around.end());
      if (around.size() == 1) out.surely.insert(*around.begin());
    }
    // Between two samples a beam may cut off a corner.
    for (double s = 0; s < 1; s += step) {
      const Vector3 p = scan.origin + s * d, q = scan.origin + std::min(1.0, s + step) * d;
      const Cell a = cellOf(p), b = cellOf(q);
      if (a.first != b.first && a.second != b.second)
        out.maybe.insert({a.first, b.second}), out.maybe.insert({b.first, a.second});
      if (b == last) break;
    }
  }
  return out;
}

void expectWhatIsPlain(const GridScan& scan) {
  const auto grid = makeSafetyGrid(window());
  const GridStats stats = grid->insert(scan);
  EXPECT_EQ(stats.not_finite, 4U);
  const Plain plain = plainly(scan);
  EXPECT_EQ(stats.rays, plain.ends.size());
  const Crossed crossed = crossedBy(scan, plain);
  const double hit = window().hit, miss = window().miss;
  const Cell center = cellOf(scan.T_world_ground.translation());
  const int half = static_cast<int>(kEdge / kCell) / 2;
  int hits = 0, misses = 0;
  for (int y = center.second - half; y < center.second + half; ++y)
    for (int x = center.first - half; x < center.first + half; ++x) {
      const double v = grid->logOdds({(x + 0.5) * kCell, (y + 0.5) * kCell, 1});
      const auto found = plain.weights.find({x, y});
      const double w = found == plain.weights.end() ? 0 : found->second;
      const auto reads = [v](double value) {  // .05 and less is read as unknown
        return std::abs(v - value) < 1e-5 || (v == 0 && std::abs(value) < 0.05 + 1e-5);
      };
      const bool as_hit = reads(w * hit), as_crossed = reads(w * hit + (1 - w) * miss);
      ASSERT_TRUE(as_hit || as_crossed) << x << ", " << y << ": " << v << " for a weight of " << w;
      EXPECT_TRUE(as_hit || crossed.maybe.count({x, y}) > 0) << "nothing was seen through it";
      EXPECT_TRUE(as_crossed || crossed.surely.count({x, y}) == 0) << "it was seen through";
      hits += w > 0, misses += !as_hit;
    }
  EXPECT_GT(hits, 100);
  EXPECT_GT(misses, 1000);
}

TEST(GridRolling2d, SaysOfEachCellWhatBeamByBeamSays) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) expectWhatIsPlain(randomScan(seed, false));
}

TEST(GridRolling2d, SaysOfEachCellWhatBeamByBeamSaysForHitsInDoubt) {
  for (std::uint64_t seed = 11; seed <= 16; ++seed) expectWhatIsPlain(randomScan(seed, true));
}

TEST(GridRolling2d, ATrustedHitIsNeverFree) {
  const auto grid = makeSafetyGrid(window());
  Rng random({21, 0, 0, 1});
  for (std::uint64_t seed = 31; seed < 41; ++seed) {
    GridScan scan = randomScan(31, seed % 2 == 0);
    scan.stamp = scan.stamp + 0.1 * static_cast<double>(seed);
    for (std::size_t i = 0; i < 200; ++i) {
      scan.hits.push_back(randomPoint(random, scan, random.uniform(0, 4), 9));
      if (!scan.weights.empty()) scan.weights.push_back(1);
    }
    std::map<Cell, double> before;
    for (std::size_t i = 0; i < scan.hits.size(); ++i)
      if (scan.hits[i].allFinite()) before[cellOf(scan.hits[i])] = grid->logOdds(scan.hits[i]);
    grid->insert(scan);
    for (const auto& [cell, weight] : plainly(scan).weights) {
      if (weight < 1) continue;
      const double v = grid->logOdds({(cell.first + 0.5) * kCell, (cell.second + 0.5) * kCell, 1});
      EXPECT_TRUE(v == 0 || v >= std::min(window().hit, before[cell]) - 1e-5) << v;
    }
  }
}

TEST(GridRolling2d, WhatStaysInTheWindowIsKeptAsItRolls) {
  const auto grid = makeSafetyGrid(window());
  GridScan scan = randomScan(41, true);
  grid->insert(scan);
  std::map<Cell, double> expected;
  for (const GridCell& cell : grid->knownCells()) expected[cellOf(cell.center)] = cell.log_odds;
  ASSERT_FALSE(expected.empty());
  Rng random({42, 0, 0, 1});
  GridScan nothing;
  nothing.stamp = scan.stamp, nothing.T_world_ground = scan.T_world_ground;
  for (int i = 0; i < 12; ++i) {
    nothing.T_world_ground.translation() +=
        Vector3(random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5), 0);
    nothing.origin = nothing.T_world_ground.translation();
    grid->insert(nothing);
    const Cell center = cellOf(nothing.T_world_ground.translation());
    const int half = static_cast<int>(kEdge / kCell) / 2;
    for (auto it = expected.begin(); it != expected.end();) {
      const int dx = it->first.first - center.first, dy = it->first.second - center.second;
      it =
          dx < -half || dy < -half || dx >= half || dy >= half ? expected.erase(it) : std::next(it);
    }
    std::map<Cell, double> known;
    for (const GridCell& cell : grid->knownCells()) known[cellOf(cell.center)] = cell.log_odds;
    EXPECT_EQ(known, expected);
  }
}

}  // namespace
}  // namespace perception
