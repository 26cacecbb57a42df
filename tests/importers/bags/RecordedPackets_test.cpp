// Captures of real devices, put into the messages in which drivers record packets: the scans are
// those of the capture itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <variant>
#include <vector>

#include "libperception/interop/bags/McapWriter.h"
#include "libperception/interop/ros/RosDevices.h"
#include "tests/importers/ImportFixture.h"
#include "tests/packets/Recorded.h"

namespace perception {
namespace {

struct Capture {
  const char* name;      ///< of the test
  const char* recorded;  ///< below the recordings
  const char* device;
  const char* metadata;  ///< file of the device below the recordings, or none
  const char* type;      ///< of the messages
  std::size_t together;  ///< packets in a message
};

class RecordedPackets : public test::ImportRun, public testing::WithParamInterface<Capture> {
 protected:
  static std::string recorded(const char* name) {
    return std::filesystem::exists(recordedFolder() + name) ? recordedFolder() + name
                                                            : recordedFolder() + name + ".gz";
  }
  /// Packets from `begin` to before `end` as one message.
  static std::string message(const std::vector<UdpPacket>& packets, std::size_t begin,
                             std::size_t end, ros::Encoding encoding) {
    const std::string type = GetParam().type;
    const ros::Header header{Stamp{packets[begin].stamp_ns}, "lidar"};
    if (type.find("PacketMsg") != std::string::npos)
      return ros::encoded(ros::OusterPacket{packets[begin].payload}, encoding);
    if (type.find("Pandar") != std::string::npos) {
      ros::PandarScan scan{header, {}};
      for (std::size_t i = begin; i < end; ++i)
        scan.packets.push_back({Stamp{packets[i].stamp_ns},
                                {packets[i].payload},
                                static_cast<std::uint32_t>(packets[i].payload.size())});
      return ros::encoded(scan, encoding);
    }
    ros::VelodyneScan scan{header, {}};
    for (std::size_t i = begin; i < end; ++i)
      scan.packets.push_back({Stamp{packets[i].stamp_ns}, {packets[i].payload}});
    return ros::encoded(scan, encoding);
  }
  void writeBag(const std::vector<UdpPacket>& packets, ros::Encoding encoding) const {
    const bool cdr = encoding == ros::Encoding::kCdr;
    const std::string word = cdr ? "cdr" : "ros1", package = cdr ? "/msg/" : "/";
    std::string type = GetParam().type, text = "std_msgs/String";
    for (std::string* name : {&type, &text}) name->replace(name->find('/'), 1, package);
    McapWriter writer(file("drive.mcap"), cdr ? "ros2" : "ros1");
    if (*GetParam().metadata != '\0') {
      std::ifstream in(recordedFolder() + GetParam().metadata, std::ios::binary);
      const std::string json{std::istreambuf_iterator<char>(in), {}};
      const auto channel = writer.addChannel("/lidar/metadata", word, {text, word + "msg", ""});
      writer.write(channel, Stamp{packets[0].stamp_ns}, ros::encoded(ros::Text{json}, encoding));
    }
    const auto channel = writer.addChannel("/lidar/packets", word, {type, word + "msg", ""});
    for (std::size_t i = 0; i < packets.size(); i += GetParam().together) {
      const std::size_t end = std::min(i + GetParam().together, packets.size());
      writer.write(channel, Stamp{packets[i].stamp_ns}, message(packets, i, end, encoding));
    }
    writer.close();
  }
};

TEST_P(RecordedPackets, InMessagesGiveTheScansOfTheirCapture) {
  SKIP_WITHOUT_RECORDINGS();
  const std::string capture = recorded(GetParam().recorded);
  std::vector<std::string> options = {"--pcap", capture, "--device", GetParam().device};
  if (*GetParam().metadata != '\0')
    options.insert(options.end(), {"--device-file", recordedFolder() + GetParam().metadata});
  const int code = import("packets", options);  // 3: a part of the turn is not recorded
  ASSERT_TRUE(code == 0 || code == 3) << error_;
  const ImportResult direct = result_;
  const auto expected = framesOf("LIDAR_TOP");
  std::vector<UdpPacket> packets = readPcap(capture).packets;
  const std::size_t port = deviceKind(GetParam().device).port;
  packets.erase(std::remove_if(packets.begin(), packets.end(),
                               [&](const UdpPacket& p) { return p.port != port; }),
                packets.end());
  for (const auto encoding : {ros::Encoding::kRos1, ros::Encoding::kCdr}) {
    writeBag(packets, encoding);
    std::filesystem::remove(file("out.rawlog"));
    ASSERT_EQ(import("bag", {"--bag", file("drive.mcap")}), 3) << error_;  // its place is not known
    EXPECT_EQ(result_.scans, direct.scans);
    EXPECT_EQ(result_.points, direct.points);
    EXPECT_GT(direct.points, 15000U);
    const auto got = framesOf("lidar_packets");
    ASSERT_EQ(got.size(), expected.size());
    for (std::size_t k = 0; k < got.size(); ++k) {
      const auto& a = std::get<LidarCloud>(got[k].data);
      const auto& b = std::get<LidarCloud>(expected[k].data);
      EXPECT_TRUE(a.x == b.x && a.y == b.y && a.z == b.z) << k;
      EXPECT_TRUE(a.intensity == b.intensity && a.ring == b.ring && a.echo == b.echo) << k;
      EXPECT_TRUE(a.time_offset == b.time_offset) << k;
      EXPECT_NEAR(got[k].stamp - expected[k].stamp, 0, 2e-7) << k;  // a log counts in 100 ns
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Devices, RecordedPackets,
    testing::Values(
        Capture{"vlp16", "vlp16/packets.pcap", "velodyne", "", "velodyne_msgs/VelodyneScan", 76},
        Capture{"vlp32c", "vlp32c/packets.pcap", "velodyne", "", "velodyne_msgs/VelodyneScan", 151},
        Capture{"pandar40p", "hesai_pandar40p/packets.pcap", "pandar40p", "",
                "pandar_msgs/PandarScan", 180},
        Capture{"xt32", "hesai_xt32/packets.pcap", "xt32", "", "pandar_msgs/PandarScan", 1},
        Capture{"ouster_dual", "ouster/OS-0-32-U1_v2.2.0_1024x10.pcap", "ouster",
                "ouster/OS-0-32-U1_v2.2.0_1024x10.json", "ouster_sensor_msgs/PacketMsg", 1},
        Capture{"ouster_legacy", "ouster/OS-1-32-G_v2.1.1_1024x10.pcap", "ouster",
                "ouster/OS-1-32-G_v2.1.1_1024x10.json", "ouster_ros/PacketMsg", 1}),
    [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace perception
