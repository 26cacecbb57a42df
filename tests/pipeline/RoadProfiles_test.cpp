#include "tests/support/RoadProfiles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "libperception/core/Angle.h"
#include "libperception/lidar/GroundPlane.h"
#include "libperception/lidar/GroundSurface.h"
#include "libperception/lidar/LidarFrontEnd.h"
#include "libperception/pipeline/SafetyMonitor.h"
#include "tests/support/StartStamp.h"

namespace perception {
namespace {

using test::kStart;
using test::Road;
using test::RoadProfile;
using test::SolidBox;
using test::SpinningLidar;

/// A vehicle on a road with a lidar (simulated), its ground and its safety grid.
class HillDrive {
 public:
  HillDrive(const RoadProfile& profile, bool reversed)
      : road_(profile, reversed), speed_(profile.speed) {
    lidar_.azimuth_step = radians(0.4);
    lidar_.fov = radians(60);
  }

  double length() const { return road_.length(); }  ///< [m]
  /// [m] from the ego origin within which an obstacle calls for a stop.
  double stopsWithin() const { return PointParams{}.vehicle_front + stoppingDistance(speed_, 0, {}); }
  double speed() const { return speed_; }
  void put(const SolidBox& box) { boxes_ = {box}; }

  /// The advice after a scan at that place of the road [m].
  FreePath scanAt(double x) {
    const Stamp stamp = kStart + x / speed_;
    SensorFrame frame = road_.castFrom(x, lidar_, boxes_, stamp);
    frame.ground = ground_.update(frame);
    EgoPoints points = usablePoints(frame, {});
    std::vector<float> heights;
    const GroundSurface surface(frame.ground, points, {}, &heights);
    monitor_.add(frame, placedReturns(std::move(points), std::move(heights), {}, {}));
    Scene scene;
    scene.stamp = stamp;
    scene.ego = frame.ego;
    scene.ego.velocity = {speed_, 0};
    return monitor_.advise(monitor_.pathAhead(scene.ego), scene);
  }

 private:
  Road road_;
  double speed_;
  SpinningLidar lidar_;
  std::vector<SolidBox> boxes_;
  GroundEstimator ground_;
  SafetyMonitor monitor_{{}, {}};
};

class EveryRoad : public testing::TestWithParam<std::pair<int, bool>> {
 protected:
  const RoadProfile& profile() const {
    return test::roadProfiles()[static_cast<std::size_t>(GetParam().first)];
  }
  bool reversed() const { return GetParam().second; }
};

TEST_P(EveryRoad, IsFree) {
  HillDrive drive(profile(), reversed());
  const double step = std::max(0.3 * drive.speed(), 2.0);
  for (double x = 2; x < drive.length() - 5; x += step) {
    const FreePath advice = drive.scanAt(x);
    EXPECT_FALSE(advice.blocked) << profile().name << ": " << x << " m, " << advice.distance << " cause " << int(advice.cause) << " seen " << advice.seen;if(getenv("V"))printf("x %.1f dist %.1f seen %.1f safe %.1f\n",x,advice.distance,advice.seen,advice.safe_speed);
    EXPECT_FALSE(advice.stop) << profile().name << ": " << x << " m, " << advice.distance << " cause " << int(advice.cause) << " seen " << advice.seen;
  }
}

/// What stands on it is called in time: in one of two scans at the stopping distance.
TEST_P(EveryRoad, WhatStandsOnItCallsForAStop) {
  const SolidBox child{{0, 0}, 0, 0.4, 0.5, 0, 1.1}, lying{{0, 0.2}, 0.3, 0.5, 1.7, 0, 0.55};
  for (const auto& [shape, share] : {std::pair(child, 0.45), std::pair(lying, 0.65)}) {
    HillDrive drive(profile(), reversed());
    SolidBox box = shape;
    box.center.x() = share * drive.length();
    drive.put(box);
    const double near = box.center.x() - drive.stopsWithin() + 0.5;
    bool stop = false;
    for (const double before : {0.2, 0.1, 0.0, -0.1})
      stop |= drive.scanAt(near - before * drive.speed()).stop;
    EXPECT_TRUE(stop) << profile().name << ": " << box.center.x() << " m, " << box.top;
  }
}

std::vector<std::pair<int, bool>> bothWays() {
  std::vector<std::pair<int, bool>> all;
  for (int k = 0; k < 20; ++k)
    for (const bool reversed : {false, true}) all.emplace_back(k, reversed);
  return all;
}
INSTANTIATE_TEST_SUITE_P(RoadProfiles, EveryRoad, testing::ValuesIn(bothWays()));

}  // namespace
}  // namespace perception
