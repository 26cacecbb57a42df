#include "libperception/sensors/frames/VelodyneCloud.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <set>

#include "libperception/sensors/frames/FromObservation.h"
#include "tests/sensors/TestFiles.h"

namespace perception {
namespace {

using namespace perception::testing;
using mrpt::obs::CObservationVelodyneScan;
using mrpt::obs::VelodyneCalibration;
using Packet = CObservationVelodyneScan::TVelodyneRawPacket;

const std::string kSamples = std::string(PERCEPTION_SHARED_DATA) + "/data/mrpt_samples/";

void put16(Packet& packet, std::size_t at, int value) {
  auto* bytes = reinterpret_cast<std::uint8_t*>(&packet);
  bytes[at] = static_cast<std::uint8_t>(value & 0xff);
  bytes[at + 1] = static_cast<std::uint8_t>(value >> 8);
}

/// A block of `packet`: bank, azimuth [0.01 deg], all returns at `distance` [2 mm].
void setBlock(Packet& packet, int block, int bank, int azimuth, int distance, int intensity = 51) {
  const std::size_t begin = static_cast<std::size_t>(block) * 100;
  put16(packet, begin, bank);
  put16(packet, begin + 2, azimuth);
  for (std::size_t k = 0; k < 32; ++k) {
    put16(packet, begin + 4 + 3 * k, distance);
    reinterpret_cast<std::uint8_t*>(&packet)[begin + 6 + 3 * k] =
        static_cast<std::uint8_t>(intensity);
  }
}

void setTail(Packet& packet, std::uint32_t us, std::uint8_t mode, std::uint8_t model) {
  auto* bytes = reinterpret_cast<std::uint8_t*>(&packet);
  for (std::size_t i = 0; i < 4; ++i) bytes[1200 + i] = static_cast<std::uint8_t>(us >> (8 * i));
  bytes[1204] = mode;
  bytes[1205] = model;
}

/// Two packets of a VLP-16 that turns 0.4 deg a block, everything 10 m away.
CObservationVelodyneScan vlp16Scan() {
  CObservationVelodyneScan scan;
  scan.scan_packets.resize(2);
  for (int p = 0; p < 2; ++p) {
    auto& packet = scan.scan_packets[static_cast<std::size_t>(p)];
    for (int b = 0; b < 12; ++b)
      setBlock(packet, b, 0xeeff, (35800 + 40 * (12 * p + b)) % 36000, 5000);
    setTail(packet, 3'599'999'000U + 1327U * static_cast<unsigned>(p), 0x37, 0x22);
  }
  return scan;
}

TEST(VelodyneCloud, BothFiringSequencesOfABlockAreDecoded) {
  VelodyneCounts counts;
  const auto cloud = velodyneCloud(vlp16Scan(), &counts);
  ASSERT_TRUE(cloud);
  EXPECT_EQ(cloud->size(), 2U * 12 * 32);
  EXPECT_EQ(counts.no_return, 0U);
  EXPECT_EQ(std::set<int>(cloud->ring.begin(), cloud->ring.end()).size(), 16U);
  EXPECT_TRUE(cloud->echo.empty());
}

TEST(VelodyneCloud, EveryPulseHasItsOwnAzimuthTimeAndElevation) {
  const auto cloud = velodyneCloud(vlp16Scan());
  ASSERT_TRUE(cloud);
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    const std::size_t block = i / 32, in_block = i % 32, laser = in_block % 16;
    // VLP-16 manual: 55.296 us a sequence, 2.304 us a laser, 110.592 us a block.
    const double us =
        55.296 * static_cast<double>(in_block / 16) + 2.304 * static_cast<double>(laser);
    const double azimuth = radians(358 + 0.4 * (static_cast<double>(block) + us / 110.592));
    const double elevation =
        radians(laser % 2 == 0 ? -15 + static_cast<double>(laser) : static_cast<double>(laser));
    EXPECT_NEAR(cloud->x[i], 10 * std::cos(elevation) * std::cos(azimuth), 1e-5);
    EXPECT_NEAR(cloud->y[i], -10 * std::cos(elevation) * std::sin(azimuth), 1e-5);
    EXPECT_NEAR(cloud->z[i], 10 * std::sin(elevation), 1e-5);
    const double packet_us = i < 384 ? 0 : 1327;
    EXPECT_NEAR(cloud->time_offset[i],
                1e-6 * (packet_us + 110.592 * static_cast<double>(block % 12) + us), 1e-9);
    EXPECT_EQ(cloud->ring[i], laser % 2 == 0 ? laser / 2 : 8 + laser / 2);
    EXPECT_FLOAT_EQ(cloud->intensity[i], 0.2F);
  }
}

TEST(VelodyneCloud, TheClockMayPassTheFullHour) {
  CObservationVelodyneScan scan = vlp16Scan();
  setTail(scan.scan_packets[1], 327, 0x37, 0x22);
  const auto cloud = velodyneCloud(scan);
  ASSERT_TRUE(cloud);
  EXPECT_NEAR(cloud->time_offset[384], 1327e-6, 1e-9);
  setTail(scan.scan_packets[1], 2'000'000'000U, 0x37, 0x22);  // a stamp that is none
  EXPECT_TRUE(velodyneCloud(scan)->time_offset.empty());
}

TEST(VelodyneCloud, DualReturnsAreTwoEchoesOfOnePulse) {
  CObservationVelodyneScan scan;
  scan.scan_packets.resize(1);
  for (int pair = 0; pair < 6; ++pair) {
    // Last return at 12 m, strongest at 10 m; in the last pair the two are one.
    setBlock(scan.scan_packets[0], 2 * pair, 0xeeff, 1000 + 40 * pair, pair == 5 ? 5000 : 6000);
    setBlock(scan.scan_packets[0], 2 * pair + 1, 0xeeff, 1000 + 40 * pair, 5000);
  }
  setTail(scan.scan_packets[0], 0, 0x39, 0x22);
  VelodyneCounts counts;
  const auto cloud = velodyneCloud(scan, &counts);
  ASSERT_TRUE(cloud);
  EXPECT_EQ(cloud->size(), 11U * 32);
  EXPECT_EQ(counts.duplicates, 32U);
  ASSERT_EQ(cloud->echo.size(), cloud->size());
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    const double range = std::hypot(cloud->x[i], cloud->y[i], cloud->z[i]);
    EXPECT_EQ(cloud->echo[i], range > 11 ? 1 : 0);
  }
  // The two blocks of a pair were fired at the same time.
  EXPECT_FLOAT_EQ(cloud->time_offset[0], cloud->time_offset[32]);
  EXPECT_NEAR(cloud->time_offset[64], 110.592e-6, 1e-9);
}

TEST(VelodyneCloud, SixtyFourLasersComeInTwoBanks) {
  CObservationVelodyneScan scan;
  scan.calibration.laser_corrections.resize(64);
  for (std::size_t k = 0; k < 64; ++k) {
    auto& laser = scan.calibration.laser_corrections[k];
    // Two banks, the lower one below, both counted downwards as in Velodyne's files.
    laser.verticalCorrection = 2 - 0.4 * static_cast<double>(k);
    laser.azimuthCorrection = k % 2 == 0 ? 1.5 : -1.5;
    laser.sinVertCorrection = std::sin(radians(laser.verticalCorrection));
    laser.cosVertCorrection = std::cos(radians(laser.verticalCorrection));
    laser.distanceCorrection = 0.5;
  }
  scan.scan_packets.resize(1);
  for (int step = 0; step < 6; ++step) {
    setBlock(scan.scan_packets[0], 2 * step, 0xeeff, 100 + 17 * step, 5000);
    setBlock(scan.scan_packets[0], 2 * step + 1, 0xddff, 100 + 17 * step, 6000);
  }
  const auto cloud = velodyneCloud(scan);
  ASSERT_TRUE(cloud);
  EXPECT_EQ(cloud->size(), 12U * 32);
  EXPECT_EQ(std::set<int>(cloud->ring.begin(), cloud->ring.end()).size(), 64U);
  EXPECT_EQ(cloud->ring[0], 63);   // laser 0 is the highest
  EXPECT_EQ(cloud->ring[32], 31);  // laser 32 the first of the lower bank
  EXPECT_NEAR(std::hypot(cloud->x[0], cloud->y[0], cloud->z[0]), 10.5, 1e-5);
  EXPECT_NEAR(std::atan2(-cloud->y[0], cloud->x[0]), radians(1 - 1.5), 1e-6);
  EXPECT_NEAR(std::hypot(cloud->x[32], cloud->y[32], cloud->z[32]), 12.5, 1e-5);
  EXPECT_NEAR(cloud->time_offset[64], 48e-6, 1e-9);
}

TEST(VelodyneCloud, BadBlocksAndUnknownInstrumentsAreCounted) {
  CObservationVelodyneScan scan = vlp16Scan();
  put16(scan.scan_packets[0], 200, 0x1234);
  put16(scan.scan_packets[1], 302, 36000);
  VelodyneCounts counts;
  const auto cloud = velodyneCloud(scan, &counts);
  ASSERT_TRUE(cloud);
  EXPECT_EQ(counts.bad_blocks, 2U);
  EXPECT_EQ(cloud->size(), 22U * 32);
  scan.calibration.laser_corrections.resize(40);
  EXPECT_FALSE(velodyneCloud(scan));
  scan.timestamp = fullScan(1)->timestamp;
  DecodeCounts dropped;
  EXPECT_FALSE(frameFromObservation(scan, &dropped));
  EXPECT_EQ(dropped.rejected, 1U);
}

TEST(VelodyneCloud, RealVlp16ScanGivesAllItsReturns) {
  const std::string file = kSamples + "test_velodyne_VLP16.rawlog";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file;
  RawlogReader reader(file);
  const auto observation = reader.next();
  ASSERT_TRUE(observation);
  DecodeCounts counts;
  const auto frame = frameFromObservation(*observation, &counts);
  ASSERT_TRUE(frame);
  const auto& cloud = std::get<LidarCloud>(frame->data);
  EXPECT_EQ(cloud.size(), 22591U);  // stock MRPT 2.5.8: 11305
  EXPECT_EQ(counts.dropped(), 0U);
  EXPECT_EQ(std::set<int>(cloud.ring.begin(), cloud.ring.end()).size(), 16U);
  // 75 packets of 1.327 ms.
  EXPECT_NEAR(*std::max_element(cloud.time_offset.begin(), cloud.time_offset.end()), 0.0995, 5e-4);
  // MRPT's own decoding, of the half that it decodes, has the same points to a beam's step.
  auto scan = std::dynamic_pointer_cast<CObservationVelodyneScan>(observation);
  scan->generatePointCloud();
  ASSERT_EQ(scan->point_cloud.size(), 11305U);
  std::size_t next = 0, found = 0;
  for (std::size_t i = 0; i < scan->point_cloud.size(); ++i) {
    const float x = scan->point_cloud.x[i], y = scan->point_cloud.y[i], z = scan->point_cloud.z[i];
    for (std::size_t k = next; k < std::min(next + 64, cloud.size()); ++k) {
      if (std::abs(cloud.z[k] - z) > 1e-3F || std::hypot(cloud.x[k] - x, cloud.y[k] - y) > 0.5F)
        continue;
      ++found, next = k + 1;
      break;
    }
  }
  EXPECT_GT(found, 11305U * 99 / 100);
}

/// Payloads of 1206 bytes in a pcap file of Ethernet, IPv4 and UDP headers (42 bytes).
std::vector<Packet> pcapPackets(const std::string& file) {
  const std::string bytes = readBytes(file);
  std::vector<Packet> packets;
  for (std::size_t at = 24; at + 16 <= bytes.size();) {
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + at + 8, 4);
    at += 16;
    if (length == 42 + sizeof(Packet) && at + length <= bytes.size()) {
      packets.emplace_back();
      std::memcpy(static_cast<void*>(&packets.back()), bytes.data() + at + 42, sizeof(Packet));
    }
    at += length;
  }
  return packets;
}

TEST(VelodyneCloud, RealHdl32PacketsGiveAllThirtyTwoBeams) {
  const std::string file = kSamples + "sample_velodyne_hdl32.pcap";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file;
  CObservationVelodyneScan scan;
  scan.scan_packets = pcapPackets(file);
  ASSERT_GT(scan.scan_packets.size(), 100U);
  scan.scan_packets.resize(100);
  std::size_t returns = 0;
  for (const auto& packet : scan.scan_packets) {
    for (const auto& block : packet.blocks) {
      for (const auto& echo : block.laser_returns) returns += 0.002 * echo.distance() >= 1;
    }
  }
  const auto cloud = velodyneCloud(scan);
  ASSERT_TRUE(cloud);
  EXPECT_EQ(cloud->size(), returns);
  std::array<int, 32> of_ring{};
  for (const auto ring : cloud->ring) ++of_ring[ring];
  // Stock MRPT leaves 16 of the 32 beams empty; sky and own roof may empty the outermost ones.
  EXPECT_GE(std::count_if(of_ring.begin(), of_ring.end(), [](int n) { return n > 50; }), 24);
}

}  // namespace
}  // namespace perception
