#pragma once
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <memory>
#include <string>

#include "libperception/sensors/frames/ToObservation.h"
#include "libperception/sensors/observations/CObservationLidarScan.h"
#include "libperception/sensors/observations/CObservationObjectDetections.h"
#include "libperception/sensors/observations/CObservationRadarScan.h"
#include "libperception/sensors/rawlog/RawlogReader.h"
#include "libperception/sensors/rawlog/RawlogWriter.h"
#include "tests/support/TemporaryFolder.h"

namespace perception::testing {

using test::TemporaryFolder;

inline std::string readBytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline void writeBytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

inline constexpr Stamp kStart{1'317'038'400'000'000'000};

/// A scan of `n` points on a circle, every optional array filled.
inline std::shared_ptr<CObservationLidarScan> fullScan(std::size_t n, Stamp stamp = kStart) {
  SensorFrame frame;
  frame.sensor = "LIDAR_TOP";
  frame.stamp = stamp;
  frame.T_ego_sensor = makePose(0.5, -0.25, 1.73, 0.1, 0.02, -0.01);
  LidarCloud c;
  for (std::size_t i = 0; i < n; ++i) {
    const float a = 0.01F * static_cast<float>(i);
    c.x.push_back(10 * std::cos(a));
    c.y.push_back(10 * std::sin(a));
    c.z.push_back(-1 + 0.001F * static_cast<float>(i));
    c.intensity.push_back(static_cast<float>(i % 64) / 64);
    c.ring.push_back(static_cast<std::uint16_t>(i % 64));
    c.time_offset.push_back(1e-5F * static_cast<float>(i));
    c.echo.push_back(static_cast<std::uint8_t>(i % 3));
    c.pulse_width.push_back(0.3F);
    c.label.push_back(static_cast<std::uint8_t>(i % 5));
  }
  c.max_range = 120;
  frame.data = c;
  return std::dynamic_pointer_cast<CObservationLidarScan>(observationFromFrame(frame));
}

inline std::shared_ptr<CObservationObjectDetections> someDetections(Stamp stamp = kStart) {
  auto o = std::make_shared<CObservationObjectDetections>();
  o->sensorLabel = "pointrcnn";
  o->timestamp = std::dynamic_pointer_cast<CObservationLidarScan>(fullScan(1, stamp))->timestamp;
  o->sensor_pose = mrpt::poses::CPose3D(0, 0, 1.73, 0, 0, 0);
  o->detections.camera = {1242, 375, 721.5, 722.5, 609.5, 172.75};
  o->detections.T_ego_camera = makePose(0.27, 0.06, 1.66, -kPi / 2, 0, -kPi / 2);
  ObjectDetection both;
  both.label = "Car";
  both.score = 8.25;
  both.class_scores = {{"Car", 0.75}, {"Van", 0.25}};
  both.image_box = ObjectDetection::ImageBox{10, 20, 110, 90};
  both.space_box = ObjectDetection::SpaceBox{{12, 3, -1.7}, 0.5, 4.5, 1.8, 1.5};
  both.heading = -1.5;
  ObjectDetection plain;
  plain.label = "Pedestrian";
  plain.score = -0.5;
  plain.image_box = ObjectDetection::ImageBox{200, 100, 220, 160};
  o->detections.objects = {both, plain};
  return o;
}

inline std::shared_ptr<CObservationRadarScan> someReturns(Stamp stamp = kStart) {
  SensorFrame frame;
  frame.sensor = "RADAR_1";
  frame.stamp = stamp;
  frame.T_ego_sensor = makePose(3.5, 0.4, 0.6, 0.3);
  RadarReturns returns;
  returns.max_range = 90;
  RadarReturn full;
  full.range = 12.5, full.bearing = -0.2, full.range_rate = -3.25, full.amplitude = 14;
  full.elevation = 0.02, full.id = 7;
  RadarReturn plain;
  plain.range = 40, plain.bearing = 0.1, plain.has_rate = false;
  returns.returns = {full, plain};
  frame.data = returns;
  return std::dynamic_pointer_cast<CObservationRadarScan>(observationFromFrame(frame));
}

/// A log of `frames` frames: pose, frame number, lidar scan, detections, radar scan.
inline void writeLog(const std::string& path, int frames, int gzip_level = 1,
                     std::size_t points = 200) {
  RawlogWriter log(path, gzip_level);
  for (int k = 0; k < frames; ++k) {
    EgoState ego;
    ego.stamp = kStart + 0.1 * k;
    ego.T_world_ego = makePose(k, 0, 0, 0);
    log.write(*poseObservation(ego));
    log.write(*frameComment(ego.stamp, k));
    log.write(*fullScan(points, ego.stamp));
    log.write(*someDetections(ego.stamp));
    log.write(*someReturns(ego.stamp));
  }
  log.close();
}

/// Reads to the end and gives the number of observations.
inline std::size_t drain(RawlogReader& reader) {
  std::size_t count = 0;
  while (reader.next()) ++count;
  return count;
}

}  // namespace perception::testing
