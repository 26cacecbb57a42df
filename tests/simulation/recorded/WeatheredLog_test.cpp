#include "libperception/simulation/recorded/WeatheredLog.h"

#include <gtest/gtest.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationImage.h>

#include <algorithm>

#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/sensors/frames/ToObservation.h"
#include "libperception/sensors/observations/Conversions.h"
#include "libperception/simulation/cameras/CameraBoxes.h"
#include "libperception/simulation/recorded/RecordedScene.h"
#include "tests/simulation/recorded/RecordedClouds.h"

namespace perception {
namespace {

constexpr Stamp kFirst{1600000000000000000};

WeatheredLog weathered(const SimulatedWeatherParams& weather) {
  Scenario scene = recordedScene({}, {}, 10);
  scene.weather = weather;
  return {std::move(scene), kFirst, 3, 1};
}

SensorFrame frameOf(const std::string& label) {
  SensorFrame frame;
  frame.sensor = label, frame.stamp = kFirst;
  return frame;
}

/// Boxes of objects on the road at 10 and 60 m, seen from 1.5 m.
SensorFrame boxes() {
  SensorFrame frame = frameOf("BOXES");
  frame.T_ego_sensor = makePose(0, 0, 1.5, 0) * opticalAxes();
  ObjectDetections found;
  found.camera.width = 1200, found.camera.height = 400;
  found.camera.fx = found.camera.fy = 700, found.camera.cx = 600, found.camera.cy = 200;
  for (int i = 0; i < 200; ++i) {
    const double range = i % 2 ? 60 : 10, bottom = 200 + 700 * 1.5 / range;
    ObjectDetection d;
    d.label = i % 2 ? "far" : "near", d.score = 0.9;
    d.image_box = {600, bottom - 700 * 1.7 / range, 640, bottom};
    found.objects.push_back(d);
  }
  frame.data = found;
  return frame;
}

TEST(WeatheredLog, ObservationsOfOtherSensorsAreKeptAndImagesWithoutPixelsLeftOut) {
  WeatheredLog log = weathered({});
  const auto imu = std::make_shared<mrpt::obs::CObservationIMU>();
  EXPECT_EQ(log.apply(imu), imu);
  const auto image = std::make_shared<mrpt::obs::CObservationImage>();
  image->timestamp = fromStamp(kFirst);
  EXPECT_EQ(log.apply(image), nullptr);
  EXPECT_EQ(log.counts().images, 1u);
  EXPECT_EQ(log.counts().images_left_out, 1u);
}

TEST(WeatheredLog, FogIsInImages) {
  SensorFrame frame = frameOf("CAMERA");
  frame.T_ego_sensor = makePose(0, 0, 1.5, 0) * opticalAxes();
  CameraImage image;
  image.camera.width = 64, image.camera.height = 32;
  image.camera.fx = image.camera.fy = 40, image.camera.cx = 31.5, image.camera.cy = 15.5;
  Raster black{64, 32, 3, std::vector<std::uint8_t>(3 * 64 * 32, 30)};
  std::fill(black.pixels.begin(), black.pixels.begin() + 3 * 64 * 12, 220);  // sky
  image.load = [black] { return std::optional<Raster>(black); };
  frame.data = image;
  SimulatedWeatherParams fog;
  fog.fog_mor = 30;
  WeatheredLog log = weathered(fog);
  const auto after = frameFromObservation(*log.apply(observationFromFrame(frame)));
  const auto seen = std::get<CameraImage>(after->data).load();
  ASSERT_TRUE(seen);
  const auto row = [&](int v) { return static_cast<int>(seen->pixels.at(3 * (64 * v + 32))); };
  EXPECT_GT(row(17), row(31) + 15);  // the far road
  EXPECT_EQ(log.counts().images_left_out, 0u);
}

TEST(WeatheredLog, FogTakesDistantBoxes) {
  SimulatedWeatherParams fog;
  fog.fog_mor = 60;
  WeatheredLog log = weathered(fog);
  const auto frame = frameFromObservation(*log.apply(observationFromFrame(boxes())));
  int near = 0, far = 0;
  for (const auto& d : std::get<ObjectDetections>(frame->data).objects)
    ++(d.label == "far" ? far : near);
  EXPECT_EQ(near, 100);  // contrast e^-0.5
  EXPECT_EQ(far, 0);     // 5 %: the end of sight
}

TEST(WeatheredLog, AWetRadomeTakesDistantTargets) {
  SimulatedWeatherParams wet;
  wet.radome_db = 12;
  WeatheredLog log = weathered(wet);
  SensorFrame frame = frameOf("RADAR");
  RadarReturns radar;
  for (int i = 0; i < 400; ++i) {
    RadarReturn r;
    r.range = i % 2 ? 100 : 10;
    radar.returns.push_back(r);
  }
  frame.data = radar;
  const auto after = frameFromObservation(*log.apply(observationFromFrame(frame)));
  int near = 0, far = 0;
  for (const auto& r : std::get<RadarReturns>(after->data).returns) {
    ++(r.range > 50 ? far : near);
    EXPECT_NEAR(r.amplitude, -24, 0.1);
  }
  EXPECT_GT(near, 190);
  EXPECT_LT(far, 100);
}

TEST(WeatheredLog, LabelsTellFlakesFromWalls) {
  SimulatedWeatherParams snow;
  snow.snow_mm_h = 10;
  WeatheredLog log = weathered(snow);
  SensorFrame frame = frameOf("LIDAR");
  frame.data = test::wallCloud(30);
  log.apply(frameComment(kFirst, 17));
  EXPECT_FALSE(log.labels());
  const auto after = frameFromObservation(*log.apply(observationFromFrame(frame)));
  const auto& cloud = std::get<LidarCloud>(after->data);
  ASSERT_TRUE(log.labels());
  EXPECT_EQ(log.frame(), 17);
  ASSERT_EQ(log.labels()->size(), cloud.size());
  std::size_t flakes = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    flakes += (*log.labels())[i] == 110;
    if ((*log.labels())[i] == 0) {
      EXPECT_NEAR(cloud.x[i], 30, 0.01);
    }
  }
  EXPECT_GT(flakes, 20u);
  EXPECT_EQ(flakes, log.counts().phantoms);
}

TEST(WeatheredLog, SaysWhatItIs) {
  SimulatedWeatherParams fog;
  fog.fog_mor = 60;
  EXPECT_EQ(weathered(fog).text(), "simulated weather on a recording: fog 60 m, seed 3");
  EXPECT_EQ(weathered({}).text(), "simulated weather on a recording: clear, seed 3");
}

}  // namespace
}  // namespace perception
