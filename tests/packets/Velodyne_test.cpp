#include "libperception/packets/Velodyne.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/packets/Pcap.h"

namespace perception {
namespace {

std::string packet(char mode, char model) {
  std::string bytes(1206, '\0');
  for (int b = 0; b < 12; ++b) bytes[100 * b] = '\xFF', bytes[100 * b + 1] = '\xEE';
  bytes[1204] = mode;
  bytes[1205] = model;
  return bytes;
}

TEST(Velodyne, PlacesAReturnInUnitsOfTheModel) {
  for (const auto& [model, unit] : {std::pair{'\x22', 0.002}, std::pair{'\x28', 0.004}}) {
    std::string bytes = packet('\x37', model);
    bytes[8] = 10;  // laser 1: 2560 units
    const LidarPacket decoded = decodeVelodyne(bytes);
    ASSERT_EQ(decoded.returns.size(), 1U);
    const LidarReturn& point = decoded.returns[0];
    EXPECT_NEAR(std::hypot(point.x, point.y, point.z), 2560 * unit, 1e-4);
  }
}

TEST(Velodyne, RefusesOtherPackets) {
  EXPECT_THROW(decodeVelodyne(std::string(1205, '\0')), DataError);
  EXPECT_THROW(decodeVelodyne(packet('\x37', '\x21')), DataError);
  std::string bytes = packet('\x37', '\x22');
  bytes[3] = '\xFF';
  EXPECT_THROW(decodeVelodyne(bytes), DataError);
}

TEST(Velodyne, DecodesEveryRecordedPacket) {
  const std::string folder = PERCEPTION_SHARED_DATA "/sensor_packets/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no recorded sensor packets";
  for (const auto& [name, count] : {std::pair{"vlp16", 603U}, std::pair{"vlp32c", 379U}}) {
    const PcapContents contents = readPcap(folder + name + "/packets.pcap");
    EXPECT_EQ(contents.packets.size(), count);
    EXPECT_TRUE(contents.warnings.empty());
    for (const UdpPacket& udp : contents.packets) {
      EXPECT_NO_THROW(decodeVelodyne(udp.payload)) << name;
    }
  }
}

}  // namespace
}  // namespace perception
