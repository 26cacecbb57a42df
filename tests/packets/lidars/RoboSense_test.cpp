// Packets of RoboSense lidars that are written here by their layout.
#include "libperception/packets/lidars/RoboSense.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <fstream>
#include <string>
#include <vector>

#include "libperception/core/Error.h"
#include "libperception/packets/Bytes.h"
#include "libperception/packets/Decoder.h"
#include "libperception/packets/Encoder.h"

namespace perception {
namespace {

/// Twelve blocks without a return, `step` [0.01 deg] apart.
std::string msop(int model, int step) {
  std::string bytes(1248, '\0');
  bytes.replace(0, 8, "\x55\xAA\x05\x0A\x5A\xA5\x50\xA0");
  bytes.replace(20, 10, std::string("\x17\x0B\x0E\x16\x0D\x14\x01\xF4\x00\xFA", 10));
  bytes[30] = static_cast<char>(model);
  for (std::size_t b = 0; b < 12; ++b) {
    bytes.replace(42 + 100 * b, 2, "\xFF\xEE");
    putBig(bytes, 44 + 100 * b, (35900 + b * static_cast<std::size_t>(step)) % 36000, 2);
  }
  return bytes;
}

void putDistance(std::string& bytes, std::size_t block, std::size_t at, std::uint64_t raw) {
  putBig(bytes, 46 + 100 * block + 3 * at, raw, 2);
  bytes[48 + 100 * block + 3 * at] = '\x33';
}

std::string difop() {
  std::string bytes(1248, '\0');
  bytes.replace(0, 8, std::string("\xA5\xFF\x00\x5A\x11\x11\x55\x55", 8));
  return bytes;
}

/// Elevations from -25 deg to 15 deg, azimuths of 8 deg to either side.
std::string difopOf32(double unit) {
  std::string bytes = difop();
  for (std::size_t i = 0; i < 32; ++i) {
    const double elevation = i == 0 ? -25 : -10 + 25.0 * static_cast<double>(i) / 31;
    bytes[468 + 3 * i] = elevation < 0 ? '\1' : '\0';
    putBig(bytes, 469 + 3 * i, static_cast<std::uint64_t>(std::lround(std::abs(elevation) / unit)),
           2);
    bytes[564 + 3 * i] = i % 2 == 0 ? '\1' : '\0';
    putBig(bytes, 565 + 3 * i, static_cast<std::uint64_t>(std::lround(8 / unit)), 2);
  }
  return bytes;
}

TEST(RoboSense, AReturnOfAnRsLidar16LiesWhereItsLayoutSays) {
  std::string bytes = msop(1, 40);
  putDistance(bytes, 3, 0, 2000);   // 10 m, the lowest beam, at 0.2 deg
  putDistance(bytes, 3, 24, 2000);  // the second firing, 15 deg up
  putDistance(bytes, 4, 1, 65535);
  const DecodedPacket packet = deviceKind("rs16").make("")->decode(bytes);
  ASSERT_EQ(packet.returns.size(), 2U);
  const LidarReturn& low = packet.returns[0];
  const double azimuth = radians(0.2), down = radians(-15), out = 10 * std::cos(down) + 0.03825;
  EXPECT_NEAR(low.x, out * std::cos(azimuth), 1e-4);
  EXPECT_NEAR(low.y, -out * std::sin(azimuth), 1e-4);
  EXPECT_NEAR(low.z, 10 * std::sin(down), 1e-4);
  EXPECT_EQ(low.ring, 0);
  EXPECT_EQ(low.intensity, 0x33);
  EXPECT_NEAR(low.time_us, 333, 1e-3);
  const LidarReturn& high = packet.returns[1];
  EXPECT_EQ(high.ring, 15);
  const double after = 55.5 + 8 * 2.8;
  EXPECT_NEAR(high.time_us, 333 + after, 1e-3);
  EXPECT_NEAR(std::atan2(-high.y, high.x), radians(0.2 + 0.4 * after / 111), 1e-5);
  EXPECT_EQ(packet.stamp_ns, 1'700'000'000'500'250'000);
}

TEST(RoboSense, TwoReturnsOfAFiringAreTwoBlocksOfOneAzimuth) {
  std::string bytes = msop(1, 40);
  for (std::size_t b = 1; b < 12; b += 2)
    bytes.replace(44 + 100 * b, 2, bytes, 44 + 100 * (b - 1), 2);
  putDistance(bytes, 2, 0, 2000), putDistance(bytes, 3, 0, 3000);
  putDistance(bytes, 4, 0, 2000), putDistance(bytes, 5, 0, 2000);
  const DecodedPacket packet = deviceKind("rs16").make("")->decode(bytes);
  ASSERT_EQ(packet.returns.size(), 3U) << "equal ones are one";
  EXPECT_EQ(packet.returns[1].echo, 1);
  EXPECT_EQ(packet.returns[1].time_us, packet.returns[0].time_us);
  EXPECT_NEAR(packet.returns[2].time_us - packet.returns[0].time_us, 111, 1e-3);
}

TEST(RoboSense, AnRsLidar32SeesNothingUntilItKnowsItsBeams) {
  for (const double unit : {0.01, 0.001}) {
    const auto decoder = deviceKind("rs32").make("");
    std::string bytes = msop(2, 20);
    putDistance(bytes, 5, 0, 1000);
    EXPECT_EQ(decoder->decode(bytes).warnings.size(), 1U);
    EXPECT_TRUE(decoder->decode(bytes).returns.empty());
    EXPECT_TRUE(decoder->decode(difopOf32(unit)).warnings.empty());
    const DecodedPacket packet = decoder->decode(bytes);
    ASSERT_EQ(packet.returns.size(), 1U);
    EXPECT_NEAR(packet.returns[0].z, 5 * std::sin(radians(-25)), 1e-4);
    const auto& p = packet.returns[0];
    const double out = 5 * std::cos(radians(-25));
    EXPECT_NEAR(p.x, out * std::cos(radians(-8)) + 0.03997, 1e-4);
    EXPECT_NEAR(p.y, -out * std::sin(radians(-8)), 1e-4);
  }
}

TEST(RoboSense, ADeviceOfAnotherModelIsRefusedAndItsAnglesAreNotTaken) {
  EXPECT_THROW(deviceKind("rs32").make("")->decode(msop(1, 40)), DataError);
  EXPECT_THROW(deviceKind("rs16").make("")->decode(msop(2, 20)), DataError);
  std::string other = msop(1, 40);
  other[3] = '\x5A';
  EXPECT_THROW(deviceKind("rs16").make("")->decode(other), DataError);
  const auto decoder = deviceKind("rs16").make("");
  EXPECT_EQ(decoder->decode(difop()).warnings.size(), 1U);
  std::string bytes = msop(1, 40);
  putDistance(bytes, 0, 15, 2000);
  EXPECT_NEAR(decoder->decode(bytes).returns.at(0).z, 10 * std::sin(radians(1)), 1e-4)
      << "the nominal angle";
}

TEST(RoboSense, AnglesOfAnRsLidar16AreThoseOfItsUnit) {
  std::string device = difop();
  for (std::size_t i = 0; i < 16; ++i) {
    const double angle = std::abs(rs16Beams()[i].elevation) + 0.05;
    putBig(device, 1165 + 3 * i, static_cast<std::uint64_t>(std::lround(angle * 1e4)), 3);
  }
  const auto beams = beamsOfDifop(device, kRs16);
  ASSERT_EQ(beams.size(), 16U);
  EXPECT_NEAR(beams[0].elevation, -15.05, 1e-6);
  EXPECT_NEAR(beams[15].elevation, 1.05, 1e-6);
  const std::string path = testing::TempDir() + "/rs16.difop";
  std::ofstream(path, std::ios::binary) << device;
  EXPECT_NEAR(robosenseBeams(path, kRs16)[8].elevation, 15.05, 1e-6);
  std::ofstream(path, std::ios::binary) << difop();
  EXPECT_THROW(robosenseBeams(path, kRs16), DataError);
  EXPECT_THROW(deviceKind("rs32").makeEncoder(""), ConfigError);
}

/// Elevations from `lowest` on in steps [0.01 deg]; other angles are not set.
std::string difopOf(std::size_t beams, int lowest, int step) {
  std::string bytes = difop();
  bytes.replace(468, 192, std::string(192, '\xFF'));
  for (std::size_t i = 0; i < beams; ++i) {
    const int angle = lowest + static_cast<int>(i) * step;
    bytes[468 + 3 * i] = angle < 0 ? '\1' : '\0';
    putBig(bytes, 469 + 3 * i, static_cast<std::uint64_t>(std::abs(angle)), 2);
    bytes.replace(564 + 3 * i, 3, std::string(3, '\0'));
  }
  return bytes;
}

TEST(RoboSense, AReturnOfAHeliosLiesWhereItsLayoutSays) {
  std::string bytes = msop(1, 20);
  bytes.replace(0, 12, std::string("\x55\xAA\x05\x5A\1\0\0\0\0\0\0\0", 12));
  putBig(bytes, 10, 1'700'000'000, 6);
  putBig(bytes, 16, 250'000, 4);
  putDistance(bytes, 5, 31, 4000);  // 10 m
  const auto decoder = deviceKind("helios32").make("");
  EXPECT_EQ(decoder->decode(bytes).warnings.size(), 1U) << "no angles yet";
  EXPECT_EQ(decoder->decode(difopOf(16, -1500, 200)).warnings.size(), 1U) << "of the other model";
  EXPECT_TRUE(decoder->decode(difopOf(32, -1600, 100)).warnings.empty());
  const DecodedPacket packet = decoder->decode(bytes);
  ASSERT_EQ(packet.returns.size(), 1U);
  EXPECT_EQ(packet.stamp_ns, 1'700'000'000'250'000'000);
  const LidarReturn& p = packet.returns[0];
  EXPECT_NEAR(p.z, 10 * std::sin(radians(15)), 1e-4);
  EXPECT_NEAR(std::hypot(p.x, p.y), 10 * std::cos(radians(15)) + 0.03498, 1e-4);
  EXPECT_NEAR(p.time_us, 5 * 55.56 + 45.15, 1e-3);

  const auto small = deviceKind("helios16").make("");
  EXPECT_EQ(small->decode(difopOf(32, -1600, 100)).warnings.size(), 1U) << "of the other model";
  EXPECT_TRUE(small->decode(difopOf(16, -1500, 200)).warnings.empty());
  const DecodedPacket second = small->decode(bytes);
  ASSERT_EQ(second.returns.size(), 1U);
  EXPECT_NEAR(second.returns[0].time_us, 5 * 2 * 55.56 + 55.56 + 43.91, 1e-3);
  EXPECT_THROW(deviceKind("rs32").make("")->decode(bytes), DataError);
  EXPECT_THROW(small->decode(msop(1, 20)), DataError);
}

TEST(RoboSense, AReturnOfABpearlLiesWhereItsLayoutSays) {
  std::string bytes = msop(3, 20);
  putDistance(bytes, 0, 0, 2000);  // 10 m
  const auto decoder = deviceKind("bpearl").make("");
  EXPECT_EQ(decoder->decode(difopOf(32, -1600, 100)).warnings.size(), 1U) << "of another model";
  EXPECT_TRUE(decoder->decode(difopOf(32, 231, 280)).warnings.empty());
  const DecodedPacket packet = decoder->decode(bytes);
  ASSERT_EQ(packet.returns.size(), 1U);
  EXPECT_NEAR(packet.returns[0].z, 10 * std::sin(radians(2.31)) + 0.09427, 1e-4);
  EXPECT_NEAR(std::hypot(packet.returns[0].x, packet.returns[0].y),
              10 * std::cos(radians(2.31)) + 0.01473, 1e-4);
  bytes[31] = '\4';
  EXPECT_THROW(decoder->decode(bytes), DataError);
}

}  // namespace
}  // namespace perception
