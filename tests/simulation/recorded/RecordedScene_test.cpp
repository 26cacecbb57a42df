#include "libperception/simulation/recorded/RecordedScene.h"

#include <gtest/gtest.h>

#include "libperception/simulation/world/World.h"

namespace perception {
namespace {

TruthObject object(std::int64_t id, const std::string& type, double t, double x, double y) {
  TruthObject o;
  o.id = id, o.type = type, o.t = t;
  o.position = {x, y, 0};
  o.length = 4, o.width = 1.8, o.height = 1.5;
  return o;
}

/// Five seconds at 10 Hz: a car at 10 m/s that is gone after 3 s, a parked one whose box trembles,
/// a tram and a region without a box.
GroundTruth street() {
  GroundTruth truth;
  for (int k = 0; k <= 50; ++k) {
    const double t = 0.1 * k;
    GroundTruth::Instant instant{
        k, t, {object(2, "Van", t, 20, k % 2 ? 5.1 : 5.0), object(3, "Tram", t, 40, -20)}};
    if (t <= 3) instant.objects.push_back(object(1, "Car", t, 10 * t, 0));
    TruthObject region = object(4, "DontCare", t, 0, 0);
    region.length = 0;
    instant.objects.push_back(region);
    truth.instants.push_back(instant);
  }
  return truth;
}

std::vector<RecordedPose> drive() {
  std::vector<RecordedPose> poses;
  for (int k = 0; k <= 50; ++k) poses.push_back({0.1 * k, makePose(0.5 * k, 3, 1, 0)});
  return poses;
}

TEST(RecordedScene, RoadUsersOfTheTruthMoveAsTheyDid) {
  const World world(recordedScene(street(), drive(), 5));
  ASSERT_EQ(world.objects(), 2u);  // nothing is known of how a tram whirls up spray
  EXPECT_EQ(world.scenario().objects[0].kind, ObjectKind::kCar);
  EXPECT_NEAR(world.object(0, 1.25).T_world_object.translation().x(), 12.5, 0.05);
  EXPECT_NEAR(world.object(0, 1.25).velocity.x(), 10, 0.1);
}

TEST(RecordedScene, ATremblingBoxIsParked) {
  const World world(recordedScene(street(), drive(), 5));
  EXPECT_EQ(world.scenario().objects[1].kind, ObjectKind::kVan);
  EXPECT_EQ(world.object(1, 2).velocity.norm(), 0);
}

TEST(RecordedScene, ObjectsAreThereWhileTheTruthHoldsThem) {
  const World world(recordedScene(street(), drive(), 5));
  EXPECT_TRUE(world.present(0, 0));
  EXPECT_TRUE(world.present(0, 3));
  EXPECT_FALSE(world.present(0, 3.2));
  EXPECT_TRUE(world.present(1, 5));
}

TEST(RecordedScene, TheVehicleIsOnAFlatRoad) {
  const World world(recordedScene(street(), drive(), 5));
  const EgoState ego = world.ego(2.5);
  EXPECT_NEAR(ego.T_world_ego.translation().x(), 12.5, 0.05);
  EXPECT_NEAR(ego.T_world_ego.translation().y(), 3, 1e-6);
  EXPECT_EQ(ego.T_world_ego.translation().z(), 0);
  EXPECT_NEAR(ego.velocity.x(), 5, 0.05);
}

TEST(RecordedScene, WithoutPosesItStandsAtTheOrigin) {
  const World world(recordedScene({}, {}, 5));
  EXPECT_EQ(world.objects(), 0u);
  EXPECT_EQ(world.ego(3).T_world_ego.translation().norm(), 0);
}

TEST(RecordedScene, AJumpOfTheAnnotationIsNoMotion) {
  GroundTruth truth = street();
  truth.instants[20].objects[2].position.x() = 900;
  const World world(recordedScene(truth, drive(), 5));
  EXPECT_NEAR(world.object(0, 2).T_world_object.translation().x(), 20, 0.5);
}

}  // namespace
}  // namespace perception
