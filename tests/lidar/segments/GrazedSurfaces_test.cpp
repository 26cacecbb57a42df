#include "libperception/lidar/segments/GrazedSurfaces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Angle.h"

namespace perception {
namespace {

using Sets = std::vector<std::vector<std::uint32_t>>;

/// A scanner 1.7 m above the ground that steps by half a degree and has a beam every 0.4 degrees.
struct Scene {
  static constexpr double kStep = radians(0.5), kBeam = radians(0.4);
  Vector3 sensor{0, 0, 1.7};
  std::vector<float> x, y, height;
  std::vector<ReturnGroup> groups;

  ReturnPlaces places() const { return {x, y, height}; }
  Sets joined() const {
    const ReturnDirections directions(places(), sensor);
    return grazedSurfaces(places(), groups, sensor, directions, azimuthStep(directions, groups));
  }

  /// The returns of column k (azimuth k steps) at a distance, between two heights.
  void addColumn(ReturnGroup& group, int k, double range, double bottom, double top) {
    for (int beam = -60; beam < 60; ++beam) {
      const double h = sensor.z() + range * std::tan(beam * kBeam);
      if (h < bottom || h > top) continue;
      group.push_back(static_cast<std::uint32_t>(x.size()));
      x.push_back(static_cast<float>(sensor.x() + range * std::cos(k * kStep)));
      y.push_back(static_cast<float>(sensor.y() + range * std::sin(k * kStep)));
      height.push_back(static_cast<float>(h));
    }
  }
  void addGroup(ReturnGroup group) { groups.push_back(std::move(group)); }

  /// One group: an upright wall across the line of sight, of columns from..to.
  void addFront(double distance, int from, int to, double bottom = 0.2, double top = 1.6) {
    ReturnGroup group;
    for (int k = from; k <= to; ++k)
      addColumn(group, k, distance / std::cos(k * kStep), bottom, top);
    addGroup(std::move(group));
  }
  /// Columns on the plane y = side, each a group of its own.
  void addSide(double side, int from, int to, double bottom = 0.2, double top = 1.6) {
    for (int k = from; k <= to; ++k) {
      ReturnGroup group;
      addColumn(group, k, side / std::sin(k * kStep), bottom, top);
      addGroup(std::move(group));
    }
  }
};

const double kSide = 17 * std::tan(-22 * Scene::kStep);  ///< [m] y of the rear's corner

TEST(GrazedSurfaces, TheStepInAzimuthIsThatOfOneBeam) {
  Scene scene;
  scene.addFront(12, -10, 10);
  EXPECT_NEAR(azimuthStep({scene.places(), scene.sensor}, scene.groups), Scene::kStep, 1e-5);
  scene.groups[0].resize(30);
  EXPECT_EQ(azimuthStep({scene.places(), scene.sensor}, scene.groups), 0) << "too few returns";
}

TEST(GrazedSurfaces, TheRearAndTheColumnsOfTheSideOfACarAreOneSurface) {
  Scene scene;
  scene.addFront(17, -33, -22);    // the rear
  scene.addSide(kSide, -21, -20);  // columns 0.9 m apart, links are 0.35 m
  EXPECT_EQ(scene.joined(), (Sets{{0, 1, 2}}));
}

TEST(GrazedSurfaces, AMissingColumnPartsThem) {
  Scene scene;
  scene.addFront(17, -33, -22);
  scene.addSide(kSide, -20, -19);
  EXPECT_TRUE(scene.joined().empty());
}

TEST(GrazedSurfaces, ColumnsThatAreNotOnALineStayApart) {
  Scene scene;
  scene.addFront(17, -33, -22);
  scene.addSide(kSide, -21, -21);
  ReturnGroup pole;
  scene.addColumn(pole, -20, 18, 0.2, 1.6);  // 1 m nearer than the side would be
  scene.addGroup(std::move(pole));
  EXPECT_TRUE(scene.joined().empty());
}

TEST(GrazedSurfaces, ALowWallBesideASignStaysApart) {
  Scene scene;
  scene.addFront(17, -33, -22, 0.2, 3);
  scene.addSide(kSide, -21, -20, 0.2, 0.5);
  EXPECT_TRUE(scene.joined().empty());
}

TEST(GrazedSurfaces, ALineAcrossTheSeamOfTheAzimuth) {
  Scene scene;
  scene.sensor = {0, 0, 1.7};
  scene.addFront(12, -10, 10);        // gives the step
  for (int k = 359; k <= 361; ++k) {  // behind the sensor, about +-180 degrees
    ReturnGroup group;
    scene.addColumn(group, k, 10 + 0.6 * (k - 359), 0.2, 1.6);
    scene.addGroup(std::move(group));
  }
  EXPECT_EQ(scene.joined(), (Sets{{1, 2, 3}}));
}

TEST(GrazedSurfaces, ARoofBelongsToTheRearBeforeIt) {
  Scene scene;
  scene.addFront(12, -4, 4, 0.3, 1.2);
  scene.addFront(13, -4, 4, 1.3, 1.5);
  EXPECT_EQ(scene.joined(), (Sets{{0, 1}}));
}

TEST(GrazedSurfaces, ACabinBelongsToTheHoodButAPersonBehindItDoesNot) {
  Scene car;
  car.addFront(12, -6, 6, 0.2, 0.9);
  car.addFront(13.4, -6, 6, 0.95, 1.5);
  EXPECT_EQ(car.joined(), (Sets{{0, 1}}));
  Scene person;
  person.addFront(12, -6, 6, 0.2, 0.9);
  person.addFront(13.4, -1, 1, 0.95, 1.75);
  EXPECT_TRUE(person.joined().empty());
}

TEST(GrazedSurfaces, ALittleOfTheSideBelowACabinDoesNotPartItFromTheHood) {
  const auto joined = [](double side_bottom) {
    Scene car;
    car.addFront(12, -6, 6, 0.2, 0.9);
    ReturnGroup cabin;
    for (int k = -6; k <= 6; ++k)  // the last column: its side
      car.addColumn(cabin, k, 13.4 / std::cos(k * Scene::kStep), k < 6 ? 0.95 : side_bottom, 1.5);
    car.addGroup(std::move(cabin));
    return car.joined();
  };
  EXPECT_EQ(joined(0.3), (Sets{{0, 1}}));
  Scene wall;  // all of it stands on the ground
  wall.addFront(12, -6, 6, 0.2, 0.9);
  wall.addFront(13.4, -6, 6, 0.3, 1.5);
  EXPECT_TRUE(wall.joined().empty());
}

TEST(GrazedSurfaces, WhatIsFarBehindOrStandsOnTheGroundIsNoRoof) {
  Scene far;
  far.addFront(12, -4, 4, 0.3, 1.2);
  far.addFront(14.5, -4, 4, 1.3, 1.5);
  EXPECT_TRUE(far.joined().empty());
  Scene next;
  next.addFront(12, -4, 4, 0.3, 0.8);
  next.addFront(13, -4, 4, 0.3, 1.4);
  EXPECT_TRUE(next.joined().empty());
}

}  // namespace
}  // namespace perception
