// Messages of drivers: their own clouds, objects of radars, and packets as the device sent them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "libperception/interop/bags/McapWriter.h"
#include "libperception/interop/ros/RosDevices.h"
#include "libperception/packets/Encoder.h"
#include "libperception/packets/FrameAssembler.h"
#include "tests/importers/ImportFixture.h"

namespace perception {
namespace {

constexpr std::int64_t kStart = 1'700'000'000'000'000'000;  // [ns]

struct WrittenTopic {
  std::string name, type;
  std::vector<std::pair<std::int64_t, std::string>> messages;  ///< [ns], bytes
  std::string definition;
};

class BagDevices : public test::ImportRun {
 protected:
  /// An MCAP file of ROS 1 or 2, and its import.
  void importOf(ros::Encoding encoding, const std::vector<WrittenTopic>& topics, int code = 0) {
    const bool cdr = encoding == ros::Encoding::kCdr;
    McapWriter writer(file("drive.mcap"), cdr ? "ros2" : "ros1");
    for (const WrittenTopic& topic : topics) {
      const auto channel =
          writer.addChannel(topic.name, cdr ? "cdr" : "ros1",
                            {topic.type, cdr ? "ros2msg" : "ros1msg", topic.definition});
      for (const auto& [stamp, bytes] : topic.messages) writer.write(channel, Stamp{stamp}, bytes);
    }
    writer.close();
    ASSERT_EQ(import("bag", {"--bag", file("drive.mcap")}), code) << error_;
  }
  static void expectSameClouds(const std::vector<SensorFrame>& got,
                               const std::vector<SensorFrame>& expected) {
    ASSERT_EQ(got.size(), expected.size());
    for (std::size_t i = 0; i < got.size(); ++i) {
      const auto& a = std::get<LidarCloud>(got[i].data);
      const auto& b = std::get<LidarCloud>(expected[i].data);
      EXPECT_GT(a.size(), 100U);
      EXPECT_EQ(a.x, b.x);
      EXPECT_EQ(a.z, b.z);
      EXPECT_EQ(a.ring, b.ring);
      EXPECT_NEAR(got[i].stamp - expected[i].stamp, 0, 2e-7);  // a log counts in 100 ns
    }
  }
};

/// A wall around a lidar.
SensorFrame aWall() {
  SensorFrame frame;
  frame.stamp = Stamp{kStart};
  LidarCloud cloud;
  for (int azimuth = 0; azimuth < 360; ++azimuth) {
    for (int beam = 0; beam < 16; ++beam) {
      const double a = radians(azimuth), e = radians(2 * beam - 15);
      cloud.x.push_back(static_cast<float>(20 * std::cos(a) * std::cos(e)));
      cloud.y.push_back(static_cast<float>(20 * std::sin(a) * std::cos(e)));
      cloud.z.push_back(static_cast<float>(20 * std::sin(e)));
      cloud.intensity.push_back(0.5F);
    }
  }
  frame.data = cloud;
  return frame;
}

/// What a device sends in three turns: time of reception [ns], bytes.
std::vector<std::pair<std::int64_t, std::string>> packetsOf(PacketEncoder& device) {
  std::vector<std::pair<std::int64_t, std::string>> packets;
  SensorFrame frame = aWall();
  for (int turn = 0; turn < 3; ++turn) {
    for (const TimedPacket& packet : device.encode(frame, 0.1))
      packets.emplace_back(frame.stamp.ns + static_cast<std::int64_t>(1e9 * packet.after),
                           packet.payload);
    frame.stamp.ns += 100'000'000;
  }
  return packets;
}

/// The scans of a device whose packets come by themselves.
std::vector<SensorFrame> scansOf(const char* device, const std::string& device_file,
                                 const std::vector<std::pair<std::int64_t, std::string>>& packets) {
  std::vector<SensorFrame> scans;
  FrameAssembler assembler(deviceKind(device), device_file, "S", Pose3::Identity(),
                           [&](SensorFrame&& scan) { scans.push_back(std::move(scan)); });
  for (const auto& [stamp, bytes] : packets) assembler.add(bytes, Stamp{stamp});
  assembler.finish();
  return scans;
}

TEST_F(BagDevices, ALivoxScanGivesItsPointsInBothEncodings) {
  for (const auto encoding : {ros::Encoding::kRos1, ros::Encoding::kCdr}) {
    ros::LivoxScan scan;
    scan.header = {Stamp{kStart}, "livox_frame"};
    scan.timebase = kStart;
    for (std::uint32_t i = 0; i < 3; ++i)
      scan.points.push_back({1'000'000 * i,
                             {10.0F + static_cast<float>(i), 1, -1},
                             51,
                             16,
                             static_cast<std::uint8_t>(i)});
    scan.point_num = 3;
    importOf(encoding,
             {{"/livox/lidar",
               encoding == ros::Encoding::kCdr ? "livox_ros_driver2/msg/CustomMsg"
                                               : "livox_ros_driver/CustomMsg",
               {{kStart, ros::encoded(scan, encoding)}},
               ""}},
             3);
    const auto frames = framesOf("livox_lidar");
    ASSERT_EQ(frames.size(), 1U);
    const auto& cloud = std::get<LidarCloud>(frames[0].data);
    ASSERT_EQ(cloud.size(), 3U);
    EXPECT_EQ(cloud.x[2], 12);
    EXPECT_NEAR(cloud.intensity[0], 0.2, 0.003);
    EXPECT_EQ(cloud.ring[2], 2);
    EXPECT_NEAR(cloud.time_offset[2], 0.002, 1e-6);
  }
}

TEST_F(BagDevices, PacketsOfAVelodyneInScanMessagesGiveTheScansOfTheirDecoder) {
  const auto packets = packetsOf(*makeVelodyneEncoder(""));
  for (const auto encoding : {ros::Encoding::kRos1, ros::Encoding::kCdr}) {
    WrittenTopic topic{"/velodyne_packets",
                       encoding == ros::Encoding::kCdr ? "velodyne_msgs/msg/VelodyneScan"
                                                       : "velodyne_msgs/VelodyneScan",
                       {},
                       ""};
    // A driver's message need not begin where a turn does.
    constexpr std::size_t kInMessage = 50;
    for (std::size_t i = 0; i < packets.size(); i += kInMessage) {
      ros::VelodyneScan scan;
      scan.header = {Stamp{packets[i].first}, "velodyne"};
      for (std::size_t k = i; k < std::min(i + kInMessage, packets.size()); ++k)
        scan.packets.push_back({Stamp{packets[k].first}, {packets[k].second}});
      topic.messages.emplace_back(packets[i].first, ros::encoded(scan, encoding));
    }
    importOf(encoding, {topic}, 3);
    EXPECT_NE(error_.find("frame \"velodyne\" has no transform"), std::string::npos) << error_;
    expectSameClouds(framesOf("velodyne_packets"), scansOf("velodyne", "", packets));
  }
}

TEST_F(BagDevices, PacketsOfHesaiAreThoseOfTheModelWhoseDecoderTakesThem) {
  const auto packets = packetsOf(*makeXt32Encoder(""));
  WrittenTopic topic{"/pandar_packets", "pandar_msgs/PandarScan", {}, ""};
  for (const auto& [stamp, bytes] : packets) {
    ros::PandarScan scan;
    scan.header = {Stamp{stamp}, "PandarXT-32"};
    scan.packets.push_back({Stamp{stamp}, {bytes}, static_cast<std::uint32_t>(bytes.size())});
    topic.messages.emplace_back(stamp, ros::encoded(scan, ros::Encoding::kRos1));
  }
  importOf(ros::Encoding::kRos1, {topic}, 3);
  expectSameClouds(framesOf("pandar_packets"), scansOf("xt32", "", packets));
}

/// A topic of an Ouster's packets, with `surplus` bytes behind each, and that of its metadata.
class BagOuster : public BagDevices {
 protected:
  void SetUp() override {
    std::string altitudes, azimuths;
    for (int i = 0; i < 16; ++i) {
      altitudes += (i > 0 ? "," : "") + std::to_string(15 - 2 * i);
      azimuths += i > 0 ? ",0" : "0";
    }
    metadata_ = R"({"beam_altitude_angles":[)" + altitudes + R"(],"beam_azimuth_angles":[)" +
                azimuths + R"(],"lidar_origin_to_beam_origin_mm":15.8,"data_format":)" +
                R"({"pixels_per_column":16,"columns_per_frame":1024,"columns_per_packet":16}})";
    write("ouster.json", metadata_);
    packets_ = packetsOf(*makeOusterEncoder(file("ouster.json")));
  }
  WrittenTopic lidar(std::size_t surplus) const {
    WrittenTopic topic{"/ouster/lidar_packets", "ouster_sensor_msgs/msg/PacketMsg", {}, ""};
    for (const auto& [stamp, bytes] : packets_)
      topic.messages.emplace_back(stamp, message(bytes + std::string(surplus, '\0')));
    return topic;
  }
  static std::string message(const std::string& bytes) {
    return ros::encoded(ros::OusterPacket{bytes}, ros::Encoding::kCdr);
  }
  WrittenTopic metadataTopic() const {
    return {"/ouster/metadata",
            "std_msgs/msg/String",
            {{kStart, ros::encoded(ros::Text{metadata_}, ros::Encoding::kCdr)}},
            ""};
  }
  std::string metadata_;
  std::vector<std::pair<std::int64_t, std::string>> packets_;
};

TEST_F(BagOuster, PacketsWithTheMetadataTopicGiveTheScansOfTheirDecoder) {
  const auto expected = scansOf("ouster", file("ouster.json"), packets_);
  for (const std::size_t surplus : {0U, 1U}) {
    WrittenTopic imu{"/ouster/imu_packets",
                     "ouster_sensor_msgs/msg/PacketMsg",
                     {{kStart, message(std::string(48, '\1'))}},
                     ""};
    importOf(ros::Encoding::kCdr, {imu, lidar(surplus), metadataTopic()}, 3);
    expectSameClouds(framesOf("ouster_lidar_packets"), expected);
  }
}

TEST_F(BagOuster, PacketsWithoutMetadataAreSaidToLackIt) {
  importOf(ros::Encoding::kCdr, {lidar(0)}, 65);
  EXPECT_NE(error_.find("without its metadata"), std::string::npos) << error_;
}

TEST_F(BagDevices, RadarTracksAreReturnsWithThePartOfTheirVelocityAlongTheLineOfSight) {
  ros::RadarTracks tracks;
  tracks.header = {Stamp{kStart}, "radar"};
  tracks.tracks.resize(1);
  tracks.tracks[0].position = {30, 40, 0};
  tracks.tracks[0].velocity = {-10, 0, 0};
  importOf(ros::Encoding::kCdr,
           {{"/radar/tracks",
             "radar_msgs/msg/RadarTracks",
             {{kStart, ros::encoded(tracks, ros::Encoding::kCdr)}},
             ""}},
           3);
  const auto frames = framesOf("radar_tracks");
  ASSERT_EQ(frames.size(), 1U);
  const auto& r = std::get<RadarReturns>(frames[0].data).returns.at(0);
  EXPECT_NEAR(r.range, 50, 1e-6);
  EXPECT_NEAR(r.bearing, std::atan2(4, 3), 1e-6);
  EXPECT_NEAR(r.range_rate, -6, 1e-6);
}

/// A scan of Livox in the vehicle's frame, beside poses.
TEST_F(BagDevices, APathIsAVehiclesPosesWhereTheIniSaysSo) {
  const auto cdr = ros::Encoding::kCdr;
  ros::LivoxScan scan;
  scan.header = {Stamp{kStart}, "base_link"};
  scan.points.push_back({0, {10, 0, 1}, 1, 0, 0});
  ros::Path path;
  std::vector<std::pair<std::int64_t, std::string>> growing;
  for (int i = 0; i < 3; ++i) {
    ros::PoseStamped pose;
    pose.header.stamp = Stamp{kStart + i * 100'000'000};
    pose.pose.position = {2.0 * i, 0, 0};
    path.poses.push_back(pose);
    growing.emplace_back(pose.header.stamp.ns, ros::encoded(path, cdr));
  }
  importOf(cdr,
           {{"/scan", "livox_interfaces/msg/CustomMsg", {{kStart, ros::encoded(scan, cdr)}}, ""},
            {"/path", "nav_msgs/msg/Path", growing, ""}},
           3);
  const auto poses = [this] {
    int count = 0;
    for (const auto& o : readLog()) count += o->sensorLabel == "EGO_POSE";
    return count;
  };
  EXPECT_EQ(poses(), 0);
  write("path.ini", "[bag]\nposes = /path\n");
  ASSERT_EQ(import("bag", {"--bag", file("drive.mcap"), "-c", file("path.ini")}), 3) << error_;
  EXPECT_EQ(poses(), 3);
}

TEST_F(BagDevices, TypesThatNobodyReadsAreNamedWithTheirFields) {
  const auto cdr = ros::Encoding::kCdr;
  ros::LivoxScan scan;
  scan.header = {Stamp{kStart}, "livox"};
  scan.points.push_back({0, {10, 0, 1}, 1, 0, 0});
  importOf(cdr,
           {{"/scan", "livox_interfaces/msg/CustomMsg", {{kStart, ros::encoded(scan, cdr)}}, ""},
            {"/odd",
             "acme_msgs/msg/Wheel",
             {{kStart, std::string("\0\1\0\0", 4)}},
             "# of one axle\nuint8 LEFT=0\nuint8 RIGHT = 1\nstd_msgs/Header header\n"
             "float64[2] speeds  # [m/s]\n" +
                 std::string(80, '=') + "\nMSG: std_msgs/Header\nstring frame_id\n"}},
           3);
  bool told = false;
  for (const std::string& note : result_.notes)
    told = told || note ==
                       "not read: /odd: 1 messages of acme_msgs/Wheel: std_msgs/Header header, "
                       "float64[2] speeds";
  EXPECT_TRUE(told);
}

}  // namespace
}  // namespace perception
