// Recordings with odd names, transforms and times of points.
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "tests/importers/OddRecording.h"

namespace perception {
namespace {

using namespace test;

class OddTopics : public OddRecording {
 protected:
  static std::vector<Planned> plainDrive() {
    const auto same = [](double t) { return t; };
    return drive(same, same);
  }
};

TEST_F(OddTopics, TopicsWithTheSameLabelAreTwoSensors) {
  std::vector<Planned> plan;
  for (Planned p : plainDrive()) {
    if (p.topic == "/points") {
      p.topic = "/front/points";
      plan.push_back(p);
      p.topic = "/front_points", p.measured += 0.03, p.recorded += 0.03;
    }
    plan.push_back(p);
  }
  importOf(plan, 0);
  EXPECT_EQ(framesOf("front_points").size(), 20U);
  EXPECT_EQ(framesOf("front_points_2").size(), 20U);
  expectSaid(
      "/front_points: another topic has the label front_points: this one has front_points_2");
}

TEST_F(OddTopics, ATransformThatIsNoPoseCostsItselfAlone) {
  auto plan = plainDrive();
  ASSERT_EQ(plan[0].topic, "/tf_static");
  plan[0].bytes = [](Stamp stamp) {
    ros::TFMessage message;
    ros::Pose none;
    none.orientation = {0, 0, 0, 0};
    message.transforms.push_back({{stamp, "base_link"}, "camera", none});
    message.transforms.push_back(
        {{stamp, "base_link"}, "velodyne", ros::messageOf(makePose(0.5, 0, 0, 0))});
    return ros::encoded(message, ros::Encoding::kCdr);
  };
  importOf(plan, 3);
  EXPECT_NEAR(framesOf("points").at(3).T_ego_sensor.translation().x(), 0.5, 1e-9);
  expectSaid("transforms of \"camera\": left out where they are a pose that is not finite");
}

TEST_F(OddTopics, PointsInWholeNumbersHaveNoUnitAndAreRefused) {
  McapWriter writer(file("drive.mcap"), "ros2");
  const auto channel =
      writer.addChannel("/points", "cdr", {"sensor_msgs/msg/PointCloud2", "ros2msg", ""});
  ros::PointCloud2 message;
  message.header = {Stamp{kBegin}, "velodyne"};
  message.height = 1, message.width = 1, message.point_step = 6, message.row_step = 6;
  for (const char* name : {"x", "y", "z"})
    message.point_fields.push_back({name,
                                    2 * static_cast<std::uint32_t>(message.point_fields.size()),
                                    ros::PointField::kI16, 1});
  message.data = std::string_view("\x10\x27\0\0\0\0", 6);
  writer.write(channel, Stamp{kBegin}, ros::encoded(message, ros::Encoding::kCdr));
  writer.close();
  EXPECT_NE(import("bag", {"--bag", file("drive.mcap")}), 0);
  expectSaid("x, y and z are whole numbers, whose unit is not said");
}

/// Two points, half a scan apart, with a field "timestamp".
std::string withTimestamps(Stamp stamp, double first) {
  ros::PointCloud2 message;
  message.header = {stamp, "velodyne"};
  message.height = 1, message.width = 2;
  std::string data;
  for (const char* name : {"x", "y", "z", "timestamp"}) {
    message.point_fields.push_back({name, message.point_step, ros::PointField::kF64, 1});
    message.point_step += sizeof(double);
  }
  for (const double time : {first, first + 0.05}) {
    for (const double value : {10.0, 1.0, 0.0, time})
      data.append(reinterpret_cast<const char*>(&value), sizeof(value));
  }
  message.row_step = 2 * message.point_step;
  message.data = data;
  return ros::encoded(message, ros::Encoding::kCdr);
}

TEST_F(OddTopics, TimestampsOfADeviceWithoutADateAreOfTheScan) {
  for (const double first : {0.0, 3577.2}) {
    auto plan = plainDrive();
    for (Planned& p : plan) {
      if (p.topic == "/points")
        p.bytes = [first](Stamp stamp) { return withTimestamps(stamp, first); };
    }
    std::filesystem::remove(file("out.rawlog"));
    importOf(plan, 0);
    const auto frames = framesOf("points");
    ASSERT_EQ(frames.size(), 20U);
    const auto& times = std::get<LidarCloud>(frames[4].data).time_offset;
    ASSERT_EQ(times.size(), 2U);
    EXPECT_NEAR(times[0], 0, 1e-6);
    EXPECT_NEAR(times[1], 0.05, 1e-6);
  }
}

}  // namespace
}  // namespace perception
