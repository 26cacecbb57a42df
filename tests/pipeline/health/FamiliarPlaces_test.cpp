#include "libperception/pipeline/health/FamiliarPlaces.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/radar/RadarModel.h"
#include "tests/support/StartStamp.h"

namespace perception {
namespace {

using test::kStart;

/// A radar that looks along x from `x` [m]; the vehicle stands unless `speed` [m/s] is given.
MeasurementScan radarScanAt(double t, double x, double speed = 0) {
  MeasurementScan scan;
  scan.modality = Modality::kRadar;
  scan.state.stamp = scan.state.ego.stamp = kStart + t;
  scan.state.T_world_sensor.translation().x() = x;
  scan.state.ego.T_world_ego.translation().x() = x;
  scan.state.ego.velocity.x() = speed;
  return scan;
}

/// Adds what the radar reports of a post at `place`; `rate` [m/s] above that of a standing one.
void report(const Vector2& place, double rate, MeasurementScan& scan) {
  const Vector2 d = place - scan.state.T_world_sensor.translation().head<2>();
  Measurement m;
  m.position = place;
  m.z = Vector3(d.norm(), std::atan2(d.y(), d.x()),
                rate - scan.state.ego.velocity.x() * d.x() / d.norm());
  m.seen = RadarModel::kAll;
  scan.measurements.push_back(m);
}

struct PostScene {
  double rate = 0;       // [m/s] of what it sees
  double moved = 0;      // [m] by the vehicle, when the silence begins
  bool there = true;     // the lidar still sees the post
  bool tracked = false;  // the post is an object
};

/// Log probability of two seconds of silence after three seconds in which the radar saw a post in
/// every scan.
double silenceAfter(const PostScene& scene) {
  const FamiliarPlaces::View view{radians(15), 150};
  const Vector2 post(30, 1);
  FamiliarPlaces places;
  const auto add = [&](const MeasurementScan& scan, bool silent) {
    std::vector<Vector2> objects;
    if (scene.tracked) objects.push_back(post);
    places.add(scan, silent, view, objects, [&](const Vector2& place) {
      EXPECT_LT((place - post).norm(), 1);
      return scene.there;
    });
  };
  for (int k = 0; k < 30; ++k) {
    MeasurementScan scan = radarScanAt(0.1 * k, 0);
    report(post, scene.rate, scan);
    add(scan, false);
  }
  EXPECT_EQ(places.logMissed(), 0);
  for (int k = 30; k < 50; ++k) add(radarScanAt(0.1 * k, scene.moved), true);
  const double silence = places.logMissed();
  MeasurementScan again = radarScanAt(5, scene.moved);
  report(post, 0, again);
  add(again, false);
  EXPECT_EQ(places.logMissed(), 0);
  return silence;
}

TEST(FamiliarPlaces, SilenceWhereAPostWasSeenAndALidarStillSeesItIsUnlikely) {
  EXPECT_LT(silenceAfter({}), std::log(1e-5));
}

TEST(FamiliarPlaces, WhatHasLeftOrMovesOrIsAnObjectIsNotExpected) {
  PostScene left, moves, object;
  left.there = false, moves.rate = 5, object.tracked = true;
  EXPECT_EQ(silenceAfter(left), 0);
  EXPECT_EQ(silenceAfter(moves), 0);
  EXPECT_EQ(silenceAfter(object), 0);
}

TEST(FamiliarPlaces, FromAnotherPlaceAWallLooksDifferent) {
  PostScene moved;
  moved.moved = 1;
  EXPECT_LT(silenceAfter(moved), std::log(1e-5));
  moved.moved = 5;
  EXPECT_EQ(silenceAfter(moved), 0);
}

TEST(FamiliarPlaces, ARadarThatDrivesKnowsNothingOfTheNextSecond) {
  FamiliarPlaces places;
  const auto there = [](const Vector2&) { return true; };
  const FamiliarPlaces::View view{radians(15), 150};
  for (int k = 0; k < 30; ++k) {
    MeasurementScan scan = radarScanAt(0.1 * k, 3.0 * k, 30);
    report({3.0 * k + 20, 0}, 0, scan);
    places.add(scan, false, view, {}, there);
  }
  for (int k = 30; k < 50; ++k)
    places.add(radarScanAt(0.1 * k, 3.0 * k, 30), true, view, {}, there);
  EXPECT_EQ(places.logMissed(), 0);
}

}  // namespace
}  // namespace perception
