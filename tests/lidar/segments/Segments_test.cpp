#include "libperception/lidar/segments/Segments.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Random.h"

namespace perception {
namespace {

/// The segments of all trees, in their order; `whole` is an index into all of them.
std::vector<Segment> segmentsOf(const SegmentFinder& finder) {
  std::vector<Segment> segments;
  for (std::size_t tree = 0; tree < finder.trees(); ++tree) {
    const auto first = static_cast<int>(segments.size());
    for (Segment& segment : finder.find(tree)) {
      if (segment.whole >= 0) segment.whole += first;
      segments.push_back(std::move(segment));
    }
  }
  return segments;
}

struct Obstacles {
  std::vector<float> x, y, height, trust;

  void add(double px, double py, double h) {
    x.push_back(static_cast<float>(px)), y.push_back(static_cast<float>(py));
    height.push_back(static_cast<float>(h));
  }
  /// An upright wall from (x0, y0) to (x1, y1), closely sampled.
  void addWall(double x0, double y0, double x1, double y1, double bottom = 0.4, double top = 1.6) {
    const int steps = static_cast<int>(std::hypot(x1 - x0, y1 - y0) / 0.1 + 0.5);
    const int rows = static_cast<int>((top - bottom) / 0.2 + 0.5);
    for (int i = 0; i <= steps; ++i) {
      const double s = static_cast<double>(i) / std::max(steps, 1);
      for (int k = 0; k <= rows; ++k) add(x0 + s * (x1 - x0), y0 + s * (y1 - y0), bottom + 0.2 * k);
    }
  }
  std::vector<Segment> segments(double min_points = 8, double max_size = 20) const {
    return segmentsOf({x, y, height, min_points, max_size, trust, {}});
  }
};

/// Two persons of half a meter side by side.
Obstacles pair(double range, double gap) {
  Obstacles o;
  o.addWall(range, -gap / 2 - 0.5, range, -gap / 2);
  o.addWall(range, gap / 2, range, gap / 2 + 0.5);
  return o;
}

TEST(Segments, PersonsNearByAreWholes) {
  const Obstacles o = pair(8, 0.4);  // links of 0.3 m
  const auto found = o.segments();
  ASSERT_EQ(found.size(), 2u);
  for (const Segment& s : found) {
    EXPECT_EQ(s.whole, -1);
    EXPECT_EQ(s.points.size(), o.x.size() / 2);
  }
  EXPECT_EQ(found[0].points[0], 0u) << "in the order of their first returns";
}

TEST(Segments, PersonsFarOffAreAWholeAndItsParts) {
  const Obstacles o = pair(40, 0.4);  // links of 0.5 m, of parts 0.3 m
  const auto found = o.segments();
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].whole, -1);
  EXPECT_EQ(found[0].points.size(), o.x.size());
  EXPECT_EQ(found[1].whole, 0);
  EXPECT_EQ(found[2].whole, 0);
  EXPECT_EQ(found[1].points.size() + found[2].points.size(), o.x.size());
}

TEST(Segments, TheLinkLengthGrowsWithTheRangeWithinItsBounds) {
  const auto wholes = [](double range, double gap) {
    const auto found = pair(range, gap).segments();
    return std::count_if(found.begin(), found.end(), [](const Segment& s) { return s.whole < 0; });
  };
  EXPECT_EQ(wholes(1, 0.29), 1) << "0.3 m at least";
  EXPECT_EQ(wholes(12, 0.31), 2);
  EXPECT_EQ(wholes(25, 0.39), 1) << "0.2 m + 0.008 x 25 m";
  EXPECT_EQ(wholes(25, 0.41), 2);
  EXPECT_EQ(wholes(70, 0.49), 1) << "0.5 m at most";
  EXPECT_EQ(wholes(70, 0.51), 2);
}

TEST(Segments, AWindowPartsABodyButNotTheWhole) {
  Obstacles car;
  car.addWall(10, -2, 10, 2, 0.4, 0.8);
  car.addWall(10, -1.5, 10, 1.5, 1.4, 1.6);  // the roof, above 0.6 m of glass
  const auto found = car.segments();
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].points.size(), car.x.size());
  EXPECT_EQ(found[1].whole, 0);
  EXPECT_EQ(found[2].whole, 0);
  EXPECT_LT(car.height[found[1].points.back()], 1);
  EXPECT_GT(car.height[found[2].points.front()], 1);
}

TEST(Segments, PartsMayHaveParts) {
  Obstacles o;
  o.addWall(40, -1, 40, 1, 0.4, 0.6);
  o.addWall(40, -1, 40, -0.2, 1.4, 1.6);  // above it, two that are 0.4 m apart
  o.addWall(40, 0.2, 40, 1, 1.4, 1.6);
  const auto found = o.segments();
  ASSERT_EQ(found.size(), 5u);
  EXPECT_EQ(found[0].whole, -1);
  EXPECT_EQ(found[1].whole, 0);
  EXPECT_EQ(found[2].whole, 0);
  EXPECT_EQ(found[3].whole, 2);
  EXPECT_EQ(found[4].whole, 2);
}

TEST(Segments, PartsReferToAWholeThatComesFirstAndHoldsThem) {
  Rng rng(RngKey{3, 0, 0, 7});
  Obstacles o;
  for (int i = 0; i < 60; ++i) {
    const double x = rng.uniform(10, 30), y = rng.uniform(-8, 8), h = rng.uniform(0.4, 2);
    for (int k = 0; k < 12; ++k) o.add(rng.normal(x, 0.2), rng.normal(y, 0.2), rng.normal(h, 0.2));
  }
  const auto found = o.segments();
  int parts = 0;
  for (std::size_t s = 0; s < found.size(); ++s) {
    const auto& points = found[s].points;
    EXPECT_TRUE(std::is_sorted(points.begin(), points.end()));
    EXPECT_GE(points.size(), 8u);
    if (found[s].whole < 0) continue;
    ++parts;
    ASSERT_LT(found[s].whole, static_cast<int>(s));
    const auto& whole = found[static_cast<std::size_t>(found[s].whole)].points;
    EXPECT_LT(points.size(), whole.size());
    EXPECT_TRUE(std::includes(whole.begin(), whole.end(), points.begin(), points.end()));
  }
  EXPECT_GT(parts, 4);
}

TEST(Segments, PartsThatAreNotWantedAreNotLookedFor) {
  const Obstacles o = pair(40, 0.4);
  std::vector<Segment> visited;
  const auto visit = [&](bool wanted) {
    visited.clear();
    const SegmentFinder finder(o.x, o.y, o.height, 8, 20, o.trust, {});
    EXPECT_EQ(finder.trees(), 1u);
    return finder.find(0, [&visited, wanted](const Segment& s) {
      visited.push_back(s);
      return wanted;
    });
  };
  EXPECT_EQ(visit(false).size(), 1u);
  EXPECT_EQ(visited.size(), 1u);
  const auto found = visit(true);
  ASSERT_EQ(found.size(), 3u);
  ASSERT_EQ(visited.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(visited[i].points, found[i].points);
    EXPECT_EQ(visited[i].whole, found[i].whole);
  }
}

TEST(Segments, OfWholesTooLongThePartsStandAlone) {
  Obstacles row;  // two cars behind each other, 0.4 m apart at 40 m
  row.addWall(40, -5, 40, -0.2);
  row.addWall(40, 0.2, 40, 5);
  EXPECT_EQ(row.segments(8, 11).size(), 3u);
  const auto alone = row.segments(8, 6);
  ASSERT_EQ(alone.size(), 2u);
  EXPECT_EQ(alone[0].whole, -1);
  EXPECT_EQ(alone[1].whole, -1);
  EXPECT_TRUE(row.segments(8, 4).empty());
}

TEST(Segments, ARowOfBeamsOnAWallIsNothingOfItsOwn) {
  const Vector3 sensor(0, 0, 0.6);
  Obstacles wall;  // 40 m long, 9 m to the left; 16 beams, whose rows lie 0.3 m apart on it
  for (int beam = -15; beam <= 15; beam += 2) {
    for (int column = -325; column <= 325; ++column) {
      const double azimuth = radians(0.2 * column), range = 9 / std::cos(azimuth);
      const double height = sensor.z() + range * std::tan(radians(beam));
      if (height > 0.3 && height < 3) wall.add(range * std::sin(azimuth), 9, height);
    }
  }
  const auto segments = segmentsOf({wall.x, wall.y, wall.height, 8, 20, wall.trust, sensor});
  for (const Segment& segment : segments) {
    double least = 90, most = -90;
    for (const std::uint32_t i : segment.points) {
      const double range = std::hypot(wall.x[i], wall.y[i]);
      const double elevation =
          degrees(std::atan2(static_cast<double>(wall.height[i]) - sensor.z(), range));
      least = std::min(least, elevation), most = std::max(most, elevation);
    }
    EXPECT_GT(most - least, 1) << segment.points.size() << " returns of one beam";
  }
  EXPECT_GT(wall.segments().size(), segments.size())
      << "without the sensor's place the beams are not known";
}

/// A wall around the scanner at 15 m, far too long for a whole, in columns 0.15 m apart, and as
/// many columns more a quarter of a meter beside its end.
Obstacles wallAndColumns(int columns) {
  constexpr double kRange = 15, kStep = 0.01;
  Obstacles o;
  const auto add = [&o](double azimuth) {
    for (double height = 0.4; height < 1.7; height += 0.2)
      o.add(kRange * std::cos(azimuth), kRange * std::sin(azimuth), height);
  };
  for (int k = 0; k <= 240; ++k) add(-1.2 + kStep * k);
  for (int k = 0; k < columns; ++k) add(1.2 + 0.25 / kRange + kStep * k);
  return o;
}

TEST(Segments, UpToThreeColumnsOfALongSurfaceAreNothingOfTheirOwn) {
  const auto found = [](int columns) {
    const Obstacles o = wallAndColumns(columns);
    return segmentsOf({o.x, o.y, o.height, 8, 20, o.trust, Vector3(0, 0, 1)}).size();
  };
  EXPECT_EQ(found(2), 0u);
  EXPECT_EQ(found(3), 0u);
  EXPECT_EQ(found(6), 1u) << "as wide as a person";
}

TEST(Segments, ReturnsCountByTheirTrust) {
  Obstacles person;
  person.addWall(10, 0, 10, 0.5);
  const auto n = static_cast<double>(person.x.size());
  EXPECT_EQ(person.segments(n).size(), 1u);
  EXPECT_EQ(person.segments(n + 1).size(), 0u);
  person.trust.assign(person.x.size(), 0.5f);
  EXPECT_EQ(person.segments(n / 2).size(), 1u);
  EXPECT_EQ(person.segments(n / 2 + 1).size(), 0u);
}

TEST(Segments, AWholeOfWhichOnePartWouldBeLeftHasNone) {
  Obstacles o;
  o.addWall(40, 0, 40, 2);
  const std::size_t large = o.x.size();
  o.addWall(40, 2.4, 40, 2.5);  // 14 returns
  EXPECT_EQ(o.segments(14).size(), 3u);
  const auto found = o.segments(15);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_GT(found[0].points.size(), large);
}

TEST(Segments, NoObstaclesHaveNone) { EXPECT_TRUE(Obstacles().segments().empty()); }

}  // namespace
}  // namespace perception
