// Messages of RoboSense's drivers: packets of returns, and those that say what the device is.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "libperception/interop/bags/McapWriter.h"
#include "libperception/interop/ros/RosDevices.h"
#include "libperception/packets/Bytes.h"
#include "libperception/packets/Encoder.h"
#include "libperception/packets/FrameAssembler.h"
#include "tests/importers/ImportFixture.h"

namespace perception {
namespace {

constexpr std::int64_t kRsBegin = 1'700'000'000'000'000'000;  // [ns]
using Packets = std::vector<std::pair<std::int64_t, std::string>>;

/// What a device says of itself: beams from `lowest` in equal steps [0.01 deg].
std::string difopPacket(int lowest = -2500, int range = 4000, std::size_t beams = 32) {
  std::string bytes(1248, '\0');
  bytes.replace(0, 8, std::string("\xA5\xFF\x00\x5A\x11\x11\x55\x55", 8));
  for (std::size_t i = 0; i < beams; ++i) {
    const auto hundredths = lowest + static_cast<int>(i) * range / static_cast<int>(beams - 1);
    bytes[468 + 3 * i] = hundredths < 0 ? '\1' : '\0';
    putBig(bytes, 469 + 3 * i, static_cast<std::uint64_t>(std::abs(hundredths)), 2);
  }
  return bytes;
}

class BagRoboSense : public test::ImportRun {
 protected:
  void SetUp() override { std::ofstream(file("unit.difop"), std::ios::binary) << difopPacket(); }
  /// Three turns past a wall.
  static Packets packetsOf(const std::string& device, const std::string& device_file) {
    SensorFrame frame;
    frame.stamp = Stamp{kRsBegin};
    LidarCloud cloud;
    for (int i = 0; i < 360 * 40; ++i) {
      const double a = radians(i / 40), e = radians(i % 40 - 25);
      cloud.x.push_back(static_cast<float>(20 * std::cos(a) * std::cos(e)));
      cloud.y.push_back(static_cast<float>(20 * std::sin(a) * std::cos(e)));
      cloud.z.push_back(static_cast<float>(20 * std::sin(e)));
      cloud.intensity.push_back(0.5F);
    }
    frame.data = cloud;
    const auto encoder = deviceKind(device).makeEncoder(device_file);
    Packets packets;
    for (int turn = 0; turn < 3; ++turn) {
      for (const TimedPacket& p : encoder->encode(frame, 0.1))
        packets.emplace_back((frame.stamp + p.after).ns, p.payload);
      frame.stamp = frame.stamp + 0.1;
    }
    return packets;
  }
  static std::vector<SensorFrame> scansOf(const std::string& device, const std::string& device_file,
                                          const Packets& packets) {
    std::vector<SensorFrame> scans;
    FrameAssembler assembler(deviceKind(device), device_file, "S", Pose3::Identity(),
                             [&](SensorFrame&& scan) { scans.push_back(std::move(scan)); });
    for (const auto& [stamp, bytes] : packets) assembler.add(bytes, Stamp{stamp});
    assembler.finish();
    return scans;
  }
  void expectScans(const std::string& label, const std::vector<SensorFrame>& expected,
                   std::size_t least = 5000) {
    const auto got = framesOf(label);
    ASSERT_EQ(got.size(), expected.size()) << error_;
    ASSERT_GE(got.size(), 3U);
    for (std::size_t i = 0; i < got.size(); ++i) {
      const auto& a = std::get<LidarCloud>(got[i].data);
      const auto& b = std::get<LidarCloud>(expected[i].data);
      EXPECT_EQ(a.x, b.x);
      EXPECT_EQ(a.z, b.z);
      EXPECT_EQ(a.ring, b.ring);
    }
    EXPECT_GT(std::get<LidarCloud>(got[1].data).size(), least);
  }
};

TEST_F(BagRoboSense, ScansOfPacketsTakeTheirAnglesFromTheOtherTopic) {
  for (const auto encoding : {ros::Encoding::kRos1, ros::Encoding::kCdr}) {
    const bool cdr = encoding == ros::Encoding::kCdr;
    const Packets packets = packetsOf("rs32", file("unit.difop"));
    McapWriter writer(file("drive.mcap"), cdr ? "ros2" : "ros1");
    const auto channel = [&](const char* topic, const char* ros1, const char* ros2) {
      return writer.addChannel(topic, cdr ? "cdr" : "ros1",
                               {cdr ? ros2 : ros1, cdr ? "ros2msg" : "ros1msg", ""});
    };
    const auto scans =
        channel("/rslidar_packets", "rslidar_msgs/rslidarScan", "rslidar_msg/msg/RslidarScan");
    const auto device = channel("/rslidar_packets_difop", "rslidar_msgs/rslidarPacket",
                                "rslidar_msg/msg/RslidarPacket");
    for (std::size_t i = 0; i < packets.size(); i += 84) {
      ros::RslidarScan scan;
      scan.header = {Stamp{packets[i].first}, "rslidar"};
      for (std::size_t k = i; k < std::min(i + 84, packets.size()); ++k)
        scan.packets.push_back({Stamp{packets[k].first}, {packets[k].second}});
      writer.write(scans, Stamp{packets[i].first}, ros::encoded(scan, encoding));
    }
    const std::string difop = difopPacket();
    writer.write(device, Stamp{packets.back().first},
                 ros::encoded(ros::RslidarPacket{Stamp{packets.back().first}, {difop}}, encoding));
    writer.close();
    ASSERT_EQ(import("bag", {"--bag", file("drive.mcap")}), 3) << error_;
    expectScans("rslidar_packets", scansOf("rs32", file("unit.difop"), packets));
  }
}

TEST_F(BagRoboSense, OtherModelsAreToldByTheirPacketsAndAngles) {
  const std::pair<const char*, std::string> devices[] = {{"helios32", difopPacket(-1600, 3100)},
                                                         {"helios16", difopPacket(-1500, 3000, 16)},
                                                         {"bpearl", difopPacket(231, 8700)}};
  for (const auto& [device, difop] : devices) {
    write("unit.difop", difop);
    const Packets packets = packetsOf(device, file("unit.difop"));
    McapWriter writer(file("drive.mcap"), "ros2");
    const auto scans = writer.addChannel("/rslidar_packets", "cdr",
                                         {"rslidar_msg/msg/RslidarScan", "ros2msg", ""});
    const auto own = writer.addChannel("/rslidar_packets_difop", "cdr",
                                       {"rslidar_msg/msg/RslidarPacket", "ros2msg", ""});
    for (const auto& [stamp, bytes] : packets) {
      ros::RslidarScan scan;
      scan.header = {Stamp{stamp}, "rslidar"};
      scan.packets.push_back({Stamp{stamp}, {bytes}});
      writer.write(scans, Stamp{stamp}, ros::encoded(scan, ros::Encoding::kCdr));
    }
    const ros::RslidarPacket said{Stamp{kRsBegin}, {difop}};
    writer.write(own, Stamp{kRsBegin}, ros::encoded(said, ros::Encoding::kCdr));
    writer.close();
    ASSERT_EQ(import("bag", {"--bag", file("drive.mcap")}), 3) << error_;
    expectScans("rslidar_packets", scansOf(device, file("unit.difop"), packets), 1000);
  }
}

TEST_F(BagRoboSense, APacketAMessageWithBothKindsOnOneTopic) {
  const auto cdr = ros::Encoding::kCdr;
  const Packets packets = packetsOf("rs16", "");
  McapWriter writer(file("drive.mcap"), "ros2");
  const auto channel = writer.addChannel("/rslidar_packets", "cdr",
                                         {"rslidar_msg/msg/RslidarPacket", "ros2msg", ""});
  const std::string difop = difopPacket();  // of another model: it is not for this one
  std::size_t count = 0;
  for (const auto& [stamp, bytes] : packets) {
    ros::RslidarMessage message;
    message.header = {Stamp{stamp}, "rslidar"};
    message.data = bytes;
    writer.write(channel, Stamp{stamp}, ros::encoded(message, cdr));
    if (count++ != 50) continue;
    message.is_difop = 1;
    message.data = std::string_view(difop).substr(0, 8);  // torn
    writer.write(channel, Stamp{stamp}, ros::encoded(message, cdr));
  }
  writer.close();
  ASSERT_EQ(import("bag", {"--bag", file("drive.mcap")}), 3) << error_;
  EXPECT_NE(error_.find("1 unreadable messages"), std::string::npos) << error_;
  expectScans("rslidar_packets", scansOf("rs16", "", packets));
}

TEST_F(BagRoboSense, PacketsOfTwoFramesOnOneTopicAreTwoSensors) {
  const auto cdr = ros::Encoding::kCdr;
  const Packets packets = packetsOf("rs16", "");
  McapWriter writer(file("drive.mcap"), "ros2");
  const auto channel =
      writer.addChannel("/packets", "cdr", {"rslidar_msg/msg/RslidarScan", "ros2msg", ""});
  constexpr std::size_t kInMessage = 20;
  for (std::size_t i = 0; i < packets.size(); i += kInMessage) {
    for (const char* frame : {"front", "rear"}) {
      ros::RslidarScan scan;
      scan.header = {Stamp{packets[i].first}, frame};
      for (std::size_t k = i; k < std::min(i + kInMessage, packets.size()); ++k)
        scan.packets.push_back({Stamp{packets[k].first}, {packets[k].second}});
      writer.write(channel, Stamp{packets[i].first}, ros::encoded(scan, cdr));
    }
  }
  writer.close();
  ASSERT_EQ(import("bag", {"--bag", file("drive.mcap")}), 3) << error_;
  expectScans("packets", scansOf("rs16", "", packets));
  expectScans("packets_rear", scansOf("rs16", "", packets));
}

TEST_F(BagRoboSense, AnotherModelIsSaidToBeNotRead) {
  const auto cdr = ros::Encoding::kCdr;
  Packets packets = packetsOf("rs16", "");
  packets[0].second[30] = '\7';
  McapWriter writer(file("drive.mcap"), "ros2");
  const auto channel =
      writer.addChannel("/lidar", "cdr", {"rslidar_msg/msg/RslidarScan", "ros2msg", ""});
  ros::RslidarScan scan;
  scan.packets.push_back({Stamp{kRsBegin}, {packets[0].second}});
  writer.write(channel, Stamp{kRsBegin}, ros::encoded(scan, cdr));
  writer.close();
  EXPECT_EQ(import("bag", {"--bag", file("drive.mcap")}), 65);
  EXPECT_NE(error_.find("model 7, expected 1 (RS-LiDAR-16), 2 (RS-LiDAR-32) or 3 (RS-Bpearl)"),
            std::string::npos)
      << error_;
}

}  // namespace
}  // namespace perception
