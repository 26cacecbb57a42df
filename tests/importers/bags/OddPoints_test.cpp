// Recordings whose clouds and receivers' messages are written in odd but legal ways.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "tests/importers/OddRecording.h"

namespace perception {
namespace {

using namespace test;

/// How the points of a message lie in its bytes.
struct PointLayout {
  std::uint32_t height = 1;
  std::uint32_t point_padding = 0;
  bool row_step = true;       ///< false: it is 0
  bool column_first = false;  ///< points of one column of beams follow each other
};

/// 48 points of 4 beams, x = beam, y = column, with a timestamp since 1970 that is 0 where there is
/// no return: in the first column.
std::string pointsOf(Stamp stamp, const PointLayout& layout) {
  constexpr std::uint32_t kBeams = 4, kColumns = 12;
  ros::PointCloud2 message;
  message.header = {stamp, "velodyne"};
  message.height = layout.height, message.width = kBeams * kColumns / layout.height;
  for (const char* name : {"x", "y", "z", "timestamp"}) {
    message.point_fields.push_back({name, message.point_step, ros::PointField::kF64, 1});
    message.point_step += sizeof(double);
  }
  message.point_step += layout.point_padding;
  std::string data;
  for (std::uint32_t i = 0; i < kBeams * kColumns; ++i) {
    const std::uint32_t beam = layout.column_first ? i % kBeams : i / kColumns;
    const std::uint32_t column = layout.column_first ? i / kBeams : i % kColumns;
    const double none = std::numeric_limits<double>::quiet_NaN();
    const double time = column == 0 ? 0 : stamp.seconds() + 0.008 * column;
    for (const double value : {column == 0 ? none : 10.0 + beam, 1.0 * column, 0.0, time})
      data.append(reinterpret_cast<const char*>(&value), sizeof(value));
    data.append(layout.point_padding, '\x7F');
  }
  message.row_step = layout.row_step ? message.width * message.point_step : 0;
  message.data = data;
  return ros::encoded(message, ros::Encoding::kCdr);
}

class OddPoints : public OddRecording {
 protected:
  static std::vector<Planned> driveOf(const PointLayout& layout) {
    const auto same = [](double t) { return t; };
    auto plan = drive(same, same);
    for (Planned& p : plan)
      if (p.topic == "/points") p.bytes = [layout](Stamp stamp) { return pointsOf(stamp, layout); };
    return plan;
  }
};

TEST_F(OddPoints, PaddingRowsAndOrderOfPointsChangeNothing) {
  const PointLayout layouts[] = {{1, 0, false, false}, {1, 8, true, false}, {4, 0, true, false},
                                 {4, 24, true, false}, {12, 0, true, true}, {1, 0, true, true}};
  for (const PointLayout& layout : layouts) {
    importOf(driveOf(layout), 0);
    const auto frames = framesOf("points");
    ASSERT_EQ(frames.size(), 20U);
    const auto& cloud = std::get<LidarCloud>(frames[4].data);
    ASSERT_EQ(cloud.size(), 44U);
    ASSERT_EQ(cloud.time_offset.size(), 44U) << "times of no returns do not matter";
    for (std::size_t i = 0; i < cloud.size(); ++i)
      EXPECT_NEAR(cloud.time_offset[i], 0.008 * static_cast<double>(cloud.y[i]), 1e-5);
  }
}

TEST_F(OddPoints, TimesThatWrapAtTheHourAreSaidAndNotUsed) {
  const auto same = [](double t) { return t; };
  auto plan = drive(same, same);
  for (Planned& p : plan) {
    if (p.topic != "/points") continue;
    p.bytes = [](Stamp stamp) {
      ros::PointCloud2 message;
      message.header = {stamp, "velodyne"};
      message.height = 1, message.width = 2;
      std::string data;
      for (const char* name : {"x", "y", "z", "timestamp"}) {
        message.point_fields.push_back({name, message.point_step, ros::PointField::kF64, 1});
        message.point_step += sizeof(double);
      }
      for (const double time : {3599.98, 0.03})
        for (const double value : {10.0, 1.0, 0.0, time})
          data.append(reinterpret_cast<const char*>(&value), sizeof(value));
      message.row_step = 2 * message.point_step;
      message.data = data;
      return ros::encoded(message, ros::Encoding::kCdr);
    };
  }
  importOf(plan, 3);
  expectSaid("returns lie more than 1.05 s outside of 20 of its scans");
}

/// Messages of OxTS's driver besides Ncom; their layouts are assumed.
TEST_F(OddPoints, MessagesOfOxtsThatAreNoReadingsAreNamedWithTheirFields) {
  McapWriter writer(file("drive.mcap"), "ros2");
  const auto scans =
      writer.addChannel("/points", "cdr", {"sensor_msgs/msg/PointCloud2", "ros2msg", ""});
  const std::pair<const char*, const char*> others[] = {
      {"NavSatRef", "float64 latitude\nfloat64 longitude\nfloat64 altitude\n"},
      {"ImuBias", "float64 gyro_x\nfloat64 gyro_y\nfloat64 gyro_z\n"},
      {"LeverArm", "float64 x\nfloat64 y\nfloat64 z\n"}};
  for (const auto& [name, fields] : others) {
    const std::string type = std::string("oxts_msgs/msg/") + name;
    const auto channel = writer.addChannel(std::string("/ins/") + name, "cdr",
                                           {type, "ros2msg",
                                            std::string("std_msgs/Header header\n") + fields +
                                                "===\nMSG: std_msgs/Header\n"
                                                "builtin_interfaces/Time stamp\nstring frame_id\n"
                                                "===\nMSG: builtin_interfaces/Time\n"
                                                "int32 sec\nuint32 nanosec\n"});
    const double numbers[] = {49, 8, 110};
    std::string bytes("\0\1\0\0\0\0\0\0\0\0\0\0\1\0\0\0\0\0\0\0", 20);
    bytes.append(reinterpret_cast<const char*>(numbers), sizeof(numbers));
    writer.write(channel, Stamp{kBegin}, bytes);
  }
  writer.write(scans, Stamp{kBegin}, cloudBytes(oneTurn(0), Stamp{kBegin}, "base_link"));
  writer.close();
  const int code = import("bag", {"--bag", file("drive.mcap")});
  EXPECT_TRUE(code == 0 || code == 3) << error_;
  for (const auto& [name, fields] : others) expectSaid(std::string("oxts_msgs/") + name);
  expectSaid("float64 latitude");
  EXPECT_TRUE(result_.others.empty());
}

TEST_F(OddPoints, OdometryOfAReceiverGivesPoses) {
  const auto same = [](double t) { return t; };
  std::vector<Planned> plan;
  for (Planned p : drive(same, same)) {
    if (p.topic == "/tf") {
      const double t = p.measured;
      p.topic = "/ins/odometry", p.type = "nav_msgs/msg/Odometry";
      p.bytes = [t](Stamp stamp) {
        ros::Odometry message;
        message.header = {stamp, "oxts_map"}, message.child_frame_id = "base_link";
        message.pose = ros::messageOf(makePose(kDriven * t, 0, 0, 0));
        return ros::encoded(message, ros::Encoding::kCdr);
      };
    }
    plan.push_back(p);
  }
  importOf(plan, 0);
  expectSaid("from /ins/odometry");
  expectPlaces(framesOf("points"));
}

}  // namespace
}  // namespace perception
