#include "tests/support/RoadProfiles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/core/Time.h"
#include "libperception/core/math/Angle.h"
#include "libperception/grid/way/StopAdvice.h"
#include "libperception/lidar/EgoPoints.h"
#include "libperception/lidar/LidarFrontEnd.h"
#include "libperception/lidar/ground/GroundPlane.h"
#include "libperception/lidar/ground/GroundSurface.h"
#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/pipeline/safety/SafetyMonitor.h"
#include "libperception/scene/Scene.h"
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
  HillDrive(const RoadProfile& profile, bool reversed, const SpinningLidar& lidar = {})
      : road_(profile, reversed), speed_(profile.speed), lidar_(lidar) {
    lidar_.azimuth_step = radians(0.4);
    lidar_.fov = radians(60);
  }

  double length() const { return road_.length(); }  ///< [m]
  /// [m] from the ego origin within which an obstacle calls for a stop.
  double stopsWithin() const {
    return PointParams{}.vehicle_front + stoppingDistance(speed_, 0, {});
  }
  double speed() const { return speed_; }
  void put(const SolidBox& box) { boxes_ = {box}; }

  /// Returns of the last scan on the box that lie well above the road.
  int returnsOfBox() const { return returns_of_box_; }

  /// The advice after a scan at that place of the road [m].
  FreePath scanAt(double x) {
    const Stamp stamp = kStart + x / speed_;
    SensorFrame frame = road_.castFrom(x, lidar_, boxes_, stamp);
    frame.ground = ground_.update(frame);
    EgoPoints points = usablePoints(frame, {});
    std::vector<float> heights;
    countReturns(points, frame.ego.T_world_ego);
    const GroundSurface surface(frame.ground, points, {}, &heights);
    monitor_.add(frame, placedReturns(std::move(points), std::move(heights), {}, {}));
    Scene scene;
    scene.stamp = stamp;
    scene.ego = frame.ego;
    scene.ego.velocity = {speed_, 0};
    return monitor_.advise(monitor_.pathAhead(scene.ego), scene);
  }

 private:
  void countReturns(const EgoPoints& points, const Pose3& T_world_ego) {
    constexpr double kAbout = 2, kWellAbove = 0.35;  // [m]
    returns_of_box_ = 0;
    for (std::size_t i = 0; i < points.size() && !boxes_.empty(); ++i) {
      const Vector3 p =
          T_world_ego * Vector3(static_cast<double>(points.x[i]), static_cast<double>(points.y[i]),
                                static_cast<double>(points.z[i]));
      const double above = p.z() - road_.heightAt(p.x(), p.y());
      const bool inside = std::abs(p.x() - boxes_[0].center.x()) < kAbout &&
                          std::abs(p.y()) < StopParams{}.width / 2;
      returns_of_box_ += inside && above > kWellAbove && above < boxes_[0].top + 0.1;
    }
  }

  Road road_;
  double speed_;
  int returns_of_box_ = 0;
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
    EXPECT_FALSE(advice.blocked) << profile().name << ": " << x << " m, " << advice.distance;
    EXPECT_FALSE(advice.stop) << profile().name << ": " << x << " m, " << advice.distance;
  }
}

TEST_P(EveryRoad, WhatStandsOnItCallsForAStopInTheScanThatShowsItWithTenReturns) {
  const SolidBox child{{0, 0}, 0, 0.4, 0.5, 0, 1.1}, lying{{0, 0.2}, 0.3, 0.5, 1.7, 0, 0.55};
  int shown = 0;
  for (const SolidBox& shape : {child, lying}) {
    for (const double share : {0.45, 0.65}) {
      HillDrive drive(profile(), reversed());
      SolidBox box = shape;
      box.center.x() = share * drive.length();
      drive.put(box);
      const double near = box.center.x() - drive.stopsWithin() + 0.5;
      for (const double before : {0.1, 0.0, -0.1}) {
        const FreePath advice = drive.scanAt(near - before * drive.speed());
        if (before > 0 || drive.returnsOfBox() < 10) continue;
        ++shown;
        EXPECT_TRUE(advice.stop) << profile().name << ": " << box.center.x() << " m, " << box.top;
      }
    }
  }
  EXPECT_GE(shown, 2);
}

std::vector<std::pair<int, bool>> bothWays() {
  std::vector<std::pair<int, bool>> all;
  for (int k = 0; k < 20; ++k)
    for (const bool reversed : {false, true}) all.emplace_back(k, reversed);
  return all;
}
INSTANTIATE_TEST_SUITE_P(RoadProfiles, EveryRoad, testing::ValuesIn(bothWays()));

// Sixteen beams see the road at 33 m and again at 99 m, or where it rises.
TEST(Highways, AreFreeForALidarOfFewBeams) {
  SpinningLidar lidar;
  lidar.beams = 16, lidar.lowest = radians(-15), lidar.highest = radians(15);
  for (const double radius : {800, 1500, 3000}) {
    RoadProfile profile;
    profile.pieces = {{60, -.04}, {.06 * radius, .02}, {100, .02}};
    profile.speed = 25;
    HillDrive drive(profile, false, lidar);
    for (double x = 0; x < drive.length() - 20; x += 5) {
      const FreePath advice = drive.scanAt(x);
      EXPECT_FALSE(advice.stop) << radius << ": " << x << " m, " << advice.distance;
    }
  }
}

}  // namespace
}  // namespace perception
