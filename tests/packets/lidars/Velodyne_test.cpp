// Packets of Velodyne lidars that are written here by their layout, and those of a recording.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "libperception/packets/Bytes.h"
#include "libperception/packets/Decoder.h"
#include "libperception/packets/Pcap.h"

namespace perception {
namespace {

constexpr int kFirst = 35900, kStep = 17;  ///< [0.01 deg] azimuth of the first block; of a block

/// A packet whose returns are all 10 m away.
std::string packetOf(char model, std::size_t raw_distance) {
  std::string bytes(1206, '\0');
  for (std::size_t b = 0; b < 12; ++b) {
    putLittle(bytes, 100 * b, 0xEEFF, 2);
    putLittle(bytes, 100 * b + 2, (kFirst + b * kStep) % 36000, 2);
    for (std::size_t j = 0; j < 32; ++j) {
      putLittle(bytes, 100 * b + 4 + 3 * j, raw_distance, 2);
      bytes[100 * b + 6 + 3 * j] = '\x33';
    }
  }
  bytes[1204] = '\x37', bytes[1205] = model;
  return bytes;
}

TEST(Velodyne, EveryLaserOfAnHdl32eHasItsElevationAzimuthAndTime) {
  const auto decoder = deviceKind("velodyne").make("");
  const DecodedPacket packet = decoder->decode(packetOf('\x21', 5000));
  ASSERT_EQ(packet.returns.size(), 12U * 32);
  for (std::size_t i = 0; i < packet.returns.size(); ++i) {
    const LidarReturn& p = packet.returns[i];
    const auto block = static_cast<double>(i / 32);
    const std::size_t laser = i % 32;
    // HDL-32E manual: 46.08 us a firing, 1.152 us a laser; lasers 0, 2, .. from -30.67 deg up,
    // 1, 3, .. from -9.33 deg up, all 4/3 deg apart.
    const double us = 1.152 * static_cast<double>(laser);
    const double azimuth = (kFirst + kStep * (block + us / 46.08)) / 100 * M_PI / 180;
    const double lowest = laser % 2 == 0 ? -30.67 : -9.33;
    const double elevation = (lowest + 4.0 / 3 * static_cast<double>(laser / 2)) * M_PI / 180;
    EXPECT_NEAR(p.x, 10 * std::cos(elevation) * std::cos(azimuth), 1e-5) << i;
    EXPECT_NEAR(p.y, -10 * std::cos(elevation) * std::sin(azimuth), 1e-5) << i;
    EXPECT_NEAR(p.z, 10 * std::sin(elevation), 1e-5) << i;
    EXPECT_NEAR(p.time_us, 46.08 * block + us, 1e-3) << i;
    EXPECT_EQ(p.ring, laser % 2 == 0 ? laser / 2 : 16 + laser / 2) << i;
  }
}

TEST(Velodyne, ARecordedHdl32eLosesNothingAndSeesLevelGround) {
  const std::string file =
      std::string(PERCEPTION_SHARED_DATA) + "/data/mrpt_samples/sample_velodyne_hdl32.pcap";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file;
  const auto decoder = deviceKind("velodyne").make("");
  SequenceCounter counter;
  std::size_t packets = 0, returns = 0, decoded = 0;
  std::map<int, std::vector<float>> heights;  // [m] above the sensor, by ring
  for (const UdpPacket& udp : readPcap(file).packets) {
    if (udp.payload.size() != 1206) continue;
    ++packets;
    for (std::size_t b = 0; b < 12; ++b)
      for (std::size_t j = 0; j < 32; ++j)
        returns += littleEndian(udp.payload, 100 * b + 4 + 3 * j, 2) > 0;
    const DecodedPacket packet = decoder->decode(udp.payload);
    counter.count(packet);
    decoded += packet.returns.size();
    for (const LidarReturn& p : packet.returns) heights[p.ring].push_back(p.z);
  }
  EXPECT_GT(packets, 100U);
  EXPECT_EQ(decoded, returns);
  EXPECT_EQ(counter.ledger().lost, 0U);
  EXPECT_EQ(heights.size(), 31U) << "one laser of this unit gives no return";
  // The ground about the vehicle is level, which beams with wrong elevations would not show; the
  // lowest beams also meet the vehicle itself.
  for (int ring = 3; ring <= 13; ++ring) {
    std::vector<float>& z = heights[ring];
    ASSERT_GT(z.size(), 1000U) << ring;
    std::nth_element(z.begin(), z.begin() + static_cast<std::ptrdiff_t>(z.size() / 4), z.end());
    EXPECT_NEAR(z[z.size() / 4], -2.07, 0.08) << ring;
  }
}

}  // namespace
}  // namespace perception
