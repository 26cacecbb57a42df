#include "libperception/pipeline/ScanMaker.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/StartStamp.h"
#include "tests/support/SyntheticCloud.h"

namespace perception {
namespace {

using test::kStart;

/// Finds one thing in every frame and, if told so, that something occludes; notes what it was
/// given.
class NotingFrontEnd final : public FrontEnd {
 public:
  explicit NotingFrontEnd(bool occludes) : occludes_(occludes) {}
  mutable std::vector<GroundPlane> grounds;
  mutable std::size_t trusts = 0;  ///< returns with a trust
  mutable std::vector<std::shared_ptr<const EarlierScan>> before;

 protected:
  Modality modality() const override { return Modality::kLidar; }
  std::shared_ptr<const MeasurementModel> model() const override { return nullptr; }
  void fill(const SensorFrame& frame, MeasurementScan& scan) const override {
    grounds.push_back(frame.ground);
    before.push_back(frame.before);
    if (const auto* cloud = std::get_if<LidarCloud>(&frame.data)) trusts += cloud->trust.size();
    scan.measurements.emplace_back();
    if (occludes_) scan.returns = std::make_shared<const PlacedReturns>();
    if (occludes_) scan.occlusion = std::make_shared<const OcclusionMap>(Vector2::Zero(), 4);
  }

 private:
  bool occludes_;
};

enum Place : std::size_t { kLidar, kCamera, kGroundOnly };

/// A lidar whose scans occlude, a camera, and a lidar for the ground alone.
struct Maker {
  std::shared_ptr<NotingFrontEnd> lidar = std::make_shared<NotingFrontEnd>(true),
                                  camera = std::make_shared<NotingFrontEnd>(false),
                                  none = std::make_shared<NotingFrontEnd>(false);
  PipelineSetup setup;
  RunTiming timing;
  EventLog events;
  WeatherWatch weather{events};
  PhantomLedger ledger{events};
  std::unique_ptr<ScanMaker> maker;

  explicit Maker(const std::string& filter = "off") {
    setup.weather.filter = filter;
    add("LIDAR", "lidar", lidar, true, true);
    add("CAMERA", "boxes", camera, true, false);
    add("ROAD", "lidar", none, false, true);
    maker = std::make_unique<ScanMaker>(setup, timing, weather, ledger);
  }
  void add(const char* label, const char* kind, std::shared_ptr<const FrontEnd> front_end,
           bool active, bool gives_ground) {
    PipelineSetup::Sensor sensor;
    sensor.label = label;
    sensor.params.kind = kind;
    sensor.front_end = std::move(front_end);
    sensor.active = active;
    sensor.gives_ground = gives_ground;
    setup.sensors.push_back(sensor);
  }
  GroundPlane groundAfter(std::size_t sensor, SensorFrame frame) const {
    maker->addGround(sensor, frame);
    return frame.ground;
  }
  MeasurementScan measure(std::size_t sensor, SensorFrame frame) const {
    maker->addGround(sensor, frame);
    return maker->measure(sensor, frame);
  }
};

/// A bare road at that height [m] in the ego frame.
SensorFrame roadAt(double t, double height) {
  test::SolidScene scene;
  scene.ground.c = height;
  test::SpinningLidar lidar;
  lidar.azimuth_step = radians(1);
  SensorFrame frame = test::castScan(scene, lidar, kStart + t);
  frame.sensor = "LIDAR";
  return frame;
}

SensorFrame imageAt(double t) {
  SensorFrame frame;
  frame.sensor = "CAMERA";
  frame.stamp = kStart + t;
  frame.data = ObjectDetections{};
  return frame;
}

SensorFrame emptyAt(double t) {
  SensorFrame frame = imageAt(t);
  frame.data = LidarCloud{};
  return frame;
}

TEST(ScanMaker, BeforeAnyLidarTheGroundIsFlatAndNotMeasured) {
  const Maker maker;
  const GroundPlane ground = maker.groundAfter(kCamera, imageAt(0));
  EXPECT_FALSE(ground.measured);
  EXPECT_EQ(ground.heightAt(10, 10), 0);
}

TEST(ScanMaker, EachScanOfALidarKnowsTheOneBeforeItUntilTheTracksStartAnew) {
  const Maker maker;
  maker.measure(kLidar, roadAt(0, 0));
  maker.measure(kCamera, imageAt(0.05));
  maker.measure(kLidar, roadAt(0.1, 0));
  maker.maker->restart();
  maker.measure(kLidar, roadAt(0.2, 0));
  ASSERT_EQ(maker.lidar->before.size(), 3u);
  EXPECT_FALSE(maker.lidar->before[0]);
  ASSERT_TRUE(maker.lidar->before[1]);
  EXPECT_EQ(maker.lidar->before[1]->stamp, kStart);
  EXPECT_FALSE(maker.lidar->before[2]);
  EXPECT_FALSE(maker.camera->before[0]);
}

TEST(ScanMaker, TheGroundOfALidarIsThatOfEverySensor) {
  const Maker maker;
  const GroundPlane seen = maker.groundAfter(kLidar, roadAt(0, -0.2));
  ASSERT_TRUE(seen.measured);
  EXPECT_NEAR(seen.c, -0.2, 0.03);
  EXPECT_EQ(maker.groundAfter(kCamera, imageAt(0.05)).c, seen.c);
  maker.measure(kCamera, imageAt(0.06));
  ASSERT_EQ(maker.camera->grounds.size(), 1U);
  EXPECT_EQ(maker.camera->grounds[0].c, seen.c);
}

TEST(ScanMaker, ALidarForTheGroundAloneGivesItToo) {
  const Maker maker;
  EXPECT_NEAR(maker.groundAfter(kGroundOnly, roadAt(0, 0.15)).c, 0.15, 0.03);
  EXPECT_NEAR(maker.groundAfter(kCamera, imageAt(0)).c, 0.15, 0.03);
}

TEST(ScanMaker, TheNewestGroundOfTwoLidarsCounts) {
  const Maker maker;
  maker.groundAfter(kLidar, roadAt(0, -0.2));
  maker.groundAfter(kGroundOnly, roadAt(0.01, 0.15));
  EXPECT_NEAR(maker.groundAfter(kCamera, imageAt(0.02)).c, 0.15, 0.03);
  EXPECT_NEAR(maker.groundAfter(kLidar, roadAt(0.1, -0.2)).c, -0.2, 0.03) << "each has its own";
}

TEST(ScanMaker, FramesWithoutReturnsKeepTheGround) {
  const Maker maker;
  const double before = maker.groundAfter(kLidar, roadAt(0, -0.2)).c;
  EXPECT_EQ(maker.groundAfter(kLidar, emptyAt(0.1)).c, before);
  EXPECT_EQ(maker.groundAfter(kLidar, imageAt(0.2)).c, before) << "no point cloud";
  EXPECT_EQ(maker.groundAfter(kCamera, imageAt(60)).c, before) << "after a gap";
}

TEST(ScanMaker, AScanIsThatOfItsSensorsFrontEnd) {
  const Maker maker;
  SensorFrame frame = imageAt(3);
  frame.frame = 42;
  const MeasurementScan scan = maker.measure(kCamera, frame);
  EXPECT_EQ(scan.sensor, "CAMERA");
  EXPECT_EQ(scan.frame, 42);
  EXPECT_EQ(scan.state.stamp, kStart + 3.0);
  EXPECT_EQ(scan.measurements.size(), 1U);
  EXPECT_TRUE(maker.lidar->grounds.empty());
}

TEST(ScanMaker, WhatOneSensorSeesOccludedIsSoForTheOthersForTwoScans) {
  const Maker maker;
  EXPECT_FALSE(maker.measure(kCamera, imageAt(0)).occlusion);
  const auto map = maker.measure(kLidar, emptyAt(1)).occlusion;
  ASSERT_TRUE(map);
  EXPECT_EQ(maker.measure(kCamera, imageAt(1)).occlusion, map);
  EXPECT_EQ(maker.measure(kCamera, imageAt(1.2)).occlusion, map);
  EXPECT_FALSE(maker.measure(kCamera, imageAt(1.201)).occlusion);
}

TEST(ScanMaker, TheNewestOcclusionCounts) {
  const Maker maker;
  const auto first = maker.measure(kLidar, emptyAt(0)).occlusion;
  const auto second = maker.measure(kLidar, emptyAt(0.1)).occlusion;
  EXPECT_NE(first, second);
  EXPECT_EQ(maker.measure(kCamera, imageAt(0.15)).occlusion, second);
}

TEST(ScanMaker, AfterTheClockWentBackAnOldOcclusionDoesNotHold) {
  const Maker maker;
  maker.measure(kLidar, emptyAt(1000));
  EXPECT_FALSE(maker.measure(kCamera, imageAt(0)).occlusion);
}

TEST(ScanMaker, AForgottenOcclusionDoesNotHold) {
  const Maker maker;
  maker.measure(kLidar, emptyAt(0));
  maker.maker->restart();
  EXPECT_FALSE(maker.measure(kCamera, imageAt(0)).occlusion);
  EXPECT_TRUE(maker.measure(kLidar, emptyAt(0.1)).occlusion) << "its own";
}

TEST(ScanMaker, ReturnsGetATrustOnlyWhereTheWeatherFilterIsOn) {
  const Maker off, on("trust");
  const SensorFrame road = roadAt(0, 0);
  const std::size_t returns = std::get<LidarCloud>(road.data).size();
  ASSERT_GT(returns, 1000U);
  off.measure(kLidar, road);
  on.measure(kLidar, road);
  EXPECT_EQ(off.lidar->trusts, 0U);
  EXPECT_EQ(on.lidar->trusts, returns);
}

TEST(ScanMaker, OnlyScansWhoseReturnsAreWeighedAreInTheLedger) {
  Maker off, on("trust");
  const SensorFrame road = roadAt(0, 0);
  for (Maker* maker : {&off, &on})
    maker->measure(kLidar, road), maker->measure(kCamera, imageAt(0));
  EXPECT_TRUE(off.ledger.take().empty());
  const auto rows = on.ledger.take();
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].sensor, "LIDAR");
  EXPECT_EQ(rows[0].stamp, kStart);
  EXPECT_EQ(rows[0].trust.returns, std::get<LidarCloud>(road.data).size());
  EXPECT_FALSE(rows[0].clusters) << "this front end has none";
}

TEST(ScanMaker, TimesItsStages) {
  Maker maker("trust");
  maker.measure(kLidar, roadAt(0, 0));
  maker.measure(kCamera, imageAt(0));
  std::string names;
  for (const auto& stage : maker.timing.stages())
    names += stage.name + ":" + std::to_string(stage.calls) + " ";
  EXPECT_EQ(names, "ground:1 weather:1 weather_state:1 lidar:1 ledger:1 boxes:1 ");
}

}  // namespace
}  // namespace perception
