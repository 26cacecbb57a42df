#include "libperception/simulation/lidar/LidarCaster.h"

#include <gtest/gtest.h>

#include "libperception/simulation/world/World.h"
#include "tests/simulation/SceneText.h"

namespace perception {
namespace {

using test::kRoofLidar, test::kStanding, test::parked, test::scenarioOf;

const Vector3 kCasterEye(0, 0, 1.73);

TEST(LidarCaster, RangeToAWallIsTheAnalyticOne) {
  // Faces at x = 9.5 and 10.5 m, 5 m high.
  const World world(scenarioOf(kStanding + kRoofLidar +
                               parked("wall", "box", 10, 0, "length = 1\nwidth = 40\nheight = 5")));
  const LidarCaster caster(world);
  for (const double azimuth : {-50.0, -20.0, 0.0, 33.0, 60.0}) {
    const Vector3 direction = makePose(0, 0, 0, radians(azimuth), radians(-4)).linear().col(0);
    const BeamHit hit = caster.cast(kCasterEye, {direction}, 100).front();
    EXPECT_EQ(hit.object, 0);
    EXPECT_EQ(hit.material, Material::kWall);
    EXPECT_NEAR(hit.range, 9.5 / direction.x(), 1e-4);
    EXPECT_NEAR(hit.cos_incidence, direction.x(), 1e-5);
  }
}

TEST(LidarCaster, RangeToASmoothRoadIsTheAnalyticOne) {
  const World world(scenarioOf(kStanding + kRoofLidar));
  const LidarCaster caster(world);
  const Vector3 down = makePose(0, 0, 0, radians(30), radians(8)).linear().col(0);
  const BeamHit hit = caster.cast(kCasterEye, {down}, 100).front();
  EXPECT_EQ(hit.object, BeamHit::kRoad);
  EXPECT_NEAR(hit.range, 1.73 / std::sin(radians(8)), 1e-4);
  EXPECT_NEAR(hit.cos_incidence, std::sin(radians(8)), 1e-5);
  EXPECT_EQ(caster.cast(kCasterEye, {down}, 5).front().object, BeamHit::kNothing)
      << "beyond range_max";
  EXPECT_EQ(caster.cast(kCasterEye, {Vector3::UnitX()}, 100).front().object, BeamHit::kNothing);
}

TEST(LidarCaster, TurnedObjectsShowTheirTurnedFaces) {
  // A square turned by 45 deg: its nearest edge stands sqrt(2)/2 * 4 m before its center.
  const World world(scenarioOf(
      kStanding + kRoofLidar +
      parked("block", "box", 20, 0, "length = 4\nwidth = 4\nheight = 5\nheading_deg = 45")));
  const LidarCaster caster(world);
  const Vector3 aim = (Vector3(20, 0.001, 1.73) - kCasterEye).normalized();
  const BeamHit hit = caster.cast(kCasterEye, {aim}, 100).front();
  EXPECT_NEAR(hit.range, 20 - 2 * std::sqrt(2.0), 0.01);
  EXPECT_NEAR(hit.cos_incidence, std::sqrt(0.5), 0.01);
}

TEST(LidarCaster, MovesThingsWithTime) {
  const World world(scenarioOf(kStanding + kRoofLidar +
                               "[object.a]\nkind = box\nlength = 1\nwidth = 9\nheight = 5\n"
                               "t = 0, 10\nx = 10, 30\ny = 0, 0\n"));
  LidarCaster caster(world);
  caster.setTime(5);
  EXPECT_NEAR(caster.cast(kCasterEye, {Vector3::UnitX()}, 100).front().range, 19.5, 1e-4);
}

TEST(LidarCaster, ResultsDoNotDependOnThreads) {
  const World world(scenarioOf(kStanding + kRoofLidar + parked("car", "car", 9, 2) +
                               parked("man", "pedestrian", 6, -2) + parked("bush", "bush", 5, 3)));
  std::vector<Vector3> directions;
  for (int i = 0; i < 20000; ++i) {
    directions.push_back(
        makePose(0, 0, 0, radians(-60 + 0.006 * i), radians(0.1 * (i % 200))).linear().col(0));
  }
  const auto one = LidarCaster(world, 1).cast(kCasterEye, directions, 100);
  const auto three = LidarCaster(world, 3).cast(kCasterEye, directions, 100);
  int objects = 0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].range, three[i].range);
    EXPECT_EQ(one[i].cos_incidence, three[i].cos_incidence);
    EXPECT_EQ(one[i].object, three[i].object);
    objects += one[i].object >= 0;
  }
  EXPECT_GT(objects, 100);
}

// A board 2 m wide at 20 m; a wall at 10 m hides what lies left of its edge.
double shareBehindWall(double edge) {
  const World world(
      scenarioOf(kStanding + kRoofLidar +
                 parked("box", "box", 20, 0, "length = 0.1\nwidth = 2\nheight = 1.5") +
                 parked("wall", "box", 10, edge + 5, "length = 0.02\nwidth = 10\nheight = 5")));
  return LidarCaster(world).visibleShare(kCasterEye, 0);
}

TEST(LidarCaster, VisibleShareIsWhatAWallLeaves) {
  // Seen from the eye the wall's edge at y covers y * 2 at twice the distance (19.95 over 9.99 m).
  constexpr double kStep = 1.0 / 16;  // columns of the grid
  EXPECT_EQ(shareBehindWall(3), 1);
  EXPECT_NEAR(shareBehindWall(0.25), 0.75, kStep);
  EXPECT_NEAR(shareBehindWall(0), 0.5, kStep);
  EXPECT_NEAR(shareBehindWall(-0.25), 0.25, kStep);
  EXPECT_EQ(shareBehindWall(-2), 0);
}

TEST(LidarCaster, AThingDoesNotHideItself) {
  const World world(scenarioOf(kStanding + kRoofLidar + parked("car", "car", 12, 3) +
                               parked("man", "pedestrian", 12, -3) +
                               parked("rider", "cyclist", 15, 0)));
  const LidarCaster caster(world);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_GT(caster.visibleShare(kCasterEye, i), 0.99) << i;
}

}  // namespace
}  // namespace perception
