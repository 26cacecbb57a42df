// Recordings as people have them, each written by its test.
#pragma once
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "libperception/interop/bags/McapWriter.h"
#include "libperception/interop/ros/RosMessages.h"
#include "libperception/interop/ros/RosSensors.h"
#include "tests/importers/ImportFixture.h"

namespace perception::test {

inline constexpr std::int64_t kBegin = 1'700'000'000'000'000'000;  // [ns]
inline constexpr int kDriveScans = 20;
inline constexpr double kScanPeriod = 0.1, kDriven = 6;  // [s], [m/s]

/// Returns around a lidar, each with its beam and the time [s] after the first.
inline LidarCloud oneTurn(int scan, double time_unit = 1, double time_start = 0) {
  LidarCloud cloud;
  for (int i = 0; i < 720; ++i) {
    const double azimuth = radians(i / 2.0), range = 15 + 5 * std::sin(3 * azimuth) + 0.01 * scan;
    cloud.x.push_back(static_cast<float>(range * std::cos(azimuth)));
    cloud.y.push_back(static_cast<float>(range * std::sin(azimuth)));
    cloud.z.push_back(static_cast<float>(i % 2) - 1.5F);
    cloud.intensity.push_back(static_cast<float>(7 * i % 50) / 50);
    cloud.ring.push_back(static_cast<std::uint16_t>(i % 2));
    cloud.time_offset.push_back(static_cast<float>(time_start + time_unit * kScanPeriod * i / 720));
  }
  return cloud;
}

/// One message of a recording that is to be written.
struct Planned {
  double measured = 0, recorded = 0;  ///< [s] after kBegin
  std::string topic;
  std::function<std::string(Stamp)> bytes;
  const char* type = "sensor_msgs/msg/PointCloud2";
};

inline std::string cloudBytes(const LidarCloud& cloud, Stamp stamp, const std::string& frame) {
  std::string data;
  return ros::encoded(ros::messageOf(cloud, {stamp, frame}, data), ros::Encoding::kCdr);
}

inline Planned scanPlan(int k, double measured, double recorded,
                        const std::string& frame = "velodyne") {
  return {measured, recorded, "/points",
          [k, frame](Stamp stamp) { return cloudBytes(oneTurn(k), stamp, frame); }};
}

inline Planned posePlan(double measured, double recorded, double x,
                        const std::string& frame = "odom", const std::string& child = "base_link") {
  return {
      measured, recorded, "/tf",
      [=](Stamp stamp) {
        ros::TFMessage message;
        message.transforms.push_back({{stamp, frame}, child, ros::messageOf(makePose(x, 0, 0, 0))});
        return ros::encoded(message, ros::Encoding::kCdr);
      },
      "tf2_msgs/msg/TFMessage"};
}

inline Planned mountPlan(const std::string& frame, double x) {
  Planned plan = posePlan(0, 0, x, "base_link", frame);
  plan.topic = "/tf_static";
  return plan;
}

inline Planned radarPlan(double measured, double recorded) {
  return {measured, recorded, "/radar",
          [](Stamp stamp) {
            ros::RadarScan scan;
            scan.header = {stamp, "base_link"};
            scan.returns.push_back({30, 0.1F, 0, -4, 12});
            return ros::encoded(scan, ros::Encoding::kCdr);
          },
          "radar_msgs/msg/RadarScan"};
}

class OddRecording : public ImportRun {
 protected:
  /// A drive whose lidar and poses have the stamp of `clock(time)`.
  static std::vector<Planned> drive(const std::function<double(double)>& lidar,
                                    const std::function<double(double)>& poses) {
    std::vector<Planned> plan = {mountPlan("velodyne", 0.5)};
    for (int k = 0; k < kDriveScans; ++k) {
      const double t = k * kScanPeriod;
      plan.push_back(posePlan(poses(t), t, kDriven * t));
      plan.push_back(scanPlan(k, lidar(t), t));
    }
    return plan;
  }
  void importOf(const std::vector<Planned>& plan, int code) {
    McapWriter writer(file("drive.mcap"), "ros2");
    std::map<std::string, std::uint16_t> channels;
    for (const Planned& p : plan) {
      if (channels.count(p.topic) == 0)
        channels[p.topic] = writer.addChannel(p.topic, "cdr", {p.type, "ros2msg", ""});
      writer.write(channels[p.topic], Stamp{kBegin} + p.recorded,
                   p.bytes(Stamp{kBegin} + p.measured));
    }
    writer.close();
    ASSERT_EQ(import("bag", {"--bag", file("drive.mcap")}), code) << error_;
  }
  /// [s] after kBegin of a sensor's frames, in the order of the log.
  std::vector<double> timesOf(const std::string& label) {
    std::vector<double> times;
    for (const SensorFrame& frame : framesOf(label)) times.push_back(frame.stamp - Stamp{kBegin});
    return times;
  }
  void expectRising(const std::vector<double>& times) {
    for (std::size_t i = 1; i < times.size(); ++i) EXPECT_GT(times[i], times[i - 1]) << i;
  }
  /// Every scan is where the vehicle was.
  void expectPlaces(const std::vector<SensorFrame>& frames) {
    for (const SensorFrame& frame : frames)
      EXPECT_NEAR(frame.ego.T_world_ego.translation().x(), kDriven * (frame.stamp - Stamp{kBegin}),
                  0.01);
  }
  void expectSaid(const std::string& text) {
    std::string said = error_;
    for (const std::string& note : result_.notes) said += note + "\n";
    EXPECT_NE(said.find(text), std::string::npos) << "'" << text << "' is not in " << said;
  }
  /// A folder of one .bin or other cloud a scan.
  void writeClouds(const std::string& ending,
                   const std::function<std::string(const LidarCloud&)>& bytes) {
    for (int k = 0; k < 3; ++k) write("clouds/" + std::to_string(k) + ending, bytes(oneTurn(k)));
  }
  void expectClouds(const std::vector<std::string>& more, int code) {
    std::vector<std::string> words = {"--clouds", file("clouds")};
    words.insert(words.end(), more.begin(), more.end());
    ASSERT_EQ(import("clouds", words), code) << error_;
    const auto frames = framesOf("LIDAR_TOP");
    ASSERT_EQ(frames.size(), 3U);
    const auto& got = std::get<LidarCloud>(frames[1].data);
    const LidarCloud expected = oneTurn(1);
    ASSERT_EQ(got.size(), expected.size());
    EXPECT_EQ(got.x, expected.x);
    EXPECT_EQ(got.z, expected.z);
    EXPECT_EQ(got.intensity, expected.intensity);
  }
};

}  // namespace perception::test
