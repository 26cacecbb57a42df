#include "libperception/scene/UntoldFronts.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/core/math/Angle.h"
#include "tests/scene/SceneFixture.h"

namespace perception {
namespace {

constexpr double kNorth = kPi / 2;

/// The own vehicle drives north along x = 0.
EgoState northbound() {
  EgoState ego;
  ego.T_world_ego = makePose(0, 0, 0, kNorth);
  return ego;
}

ClassTable walkersAndCars() {
  ClassTable classes = test::pedestrianAndCar();
  classes.classes[0].motion = findMotionModel("constant-velocity");
  classes.classes[1].motion = findMotionModel("wheeled");
  return classes;
}

SceneObject parked(double x, double y, double yaw, double p_front = 0.5) {
  SceneObject car = test::someCar();
  car.position = {x, y, 0};
  car.yaw = yaw;
  car.p_front = p_front;
  car.speed = 0.1;
  car.velocity = {0.1 * std::cos(yaw), 0.1 * std::sin(yaw)};
  car.sd_speed = 0.2;
  return car;
}

/// The objects as they are shown, the first one first.
std::vector<SceneObject> shown(std::vector<SceneObject> objects,
                               TrafficSide traffic = TrafficSide::kRight) {
  turnUntoldFronts(northbound(), traffic, walkersAndCars(), objects);
  return objects;
}

void expectYaw(const SceneObject& o, double yaw) {
  EXPECT_LT(std::abs(wrapAngle(o.yaw - yaw)), 1e-9) << o.yaw;
}

TEST(UntoldFronts, FaceAsTheirSideOfTheRoad) {
  expectYaw(shown({parked(3.5, 20, -kNorth)})[0], kNorth);
  expectYaw(shown({parked(3.5, 20, kNorth)})[0], kNorth);
  expectYaw(shown({parked(0, 20, -kNorth)})[0], kNorth);
  expectYaw(shown({parked(-7, 20, kNorth)})[0], -kNorth);
  expectYaw(shown({parked(3.5, 20, kNorth)}, TrafficSide::kLeft)[0], -kNorth);
  expectYaw(shown({parked(3.5, 20, -kNorth)}, TrafficSide::kUnknown)[0], -kNorth);
  expectYaw(shown({parked(3.5, 20, 0)})[0], 0);             // across the road
  expectYaw(shown({parked(30, 20, -kNorth)})[0], -kNorth);  // along another road
}

TEST(UntoldFronts, ARowOfParkedCarsFacesOneWay) {
  // A one-way street: the cars on the left face as the own vehicle.
  expectYaw(shown({parked(-4, 20, -kNorth), parked(-4.3, 27, kNorth, 0.97)})[0], kNorth);
  expectYaw(shown({parked(-4, 20, -kNorth), parked(-4.3, 14, kNorth, 0.97),
                   parked(-4.3, 40, -kNorth, 0.97)})[0],
            kNorth);
  expectYaw(shown({parked(-4, 20, kNorth), parked(-8, 27, kNorth, 0.97)})[0], -kNorth);
}

TEST(UntoldFronts, OthersMakeNoFrontKnown) {
  const SceneObject turned = shown({parked(-4, 20, -kNorth, 0.4), parked(-4, 27, kNorth, 0.97)})[0];
  expectYaw(turned, kNorth);
  EXPECT_GT(turned.p_front, 0.7);
  EXPECT_LT(shown({parked(3.5, 20, kNorth, 0.89)})[0].p_front, kSureFront);
  EXPECT_EQ(turned.velocity, parked(-4, 20, -kNorth).velocity);
  EXPECT_EQ(turned.speed, -0.1);
}

TEST(UntoldFronts, WhatTellsItsFrontItselfStaysAsItIs) {
  SceneObject wrong_way = parked(3.5, 20, -kNorth, 0.95);
  expectYaw(shown({wrong_way})[0], -kNorth);
  EXPECT_EQ(shown({wrong_way})[0].p_front, 0.95);
  SceneObject drives = parked(3.5, 20, -kNorth, 0.8);
  drives.speed = 3;
  expectYaw(shown({drives})[0], -kNorth);
  expectYaw(shown({parked(3.5, 20, -kNorth, 0.8)})[0], -kNorth);  // its shape says more
  SceneObject walker = parked(3.5, 20, -kNorth);
  walker.class_id = 0;
  expectYaw(shown({walker})[0], -kNorth);
}

}  // namespace
}  // namespace perception
