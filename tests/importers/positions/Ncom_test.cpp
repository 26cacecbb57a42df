#include "libperception/importers/positions/Ncom.h"

#include <gtest/gtest.h>
#include <mrpt/obs/CObservationGPS.h>

#include <cstdint>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "libperception/interop/bags/McapWriter.h"
#include "libperception/packets/Bytes.h"
#include "libperception/sensors/satellites/GnssFix.h"
#include "tests/importers/ImportFixture.h"

namespace perception {
namespace {

constexpr std::int64_t kNcomBegin = 1'700'000'000'000'000'000;  // [ns]

template <class Number>
void putBytes(std::string& packet, std::size_t at, Number value) {
  std::memcpy(packet.data() + at, &value, sizeof value);
}

/// A packet of a system at 49 deg north, 8.4 deg east that drives 10 m/s to the south east.
std::string ncomPacket(char status) {
  std::string packet(72, '\0');
  packet[0] = '\xE7';
  packet[21] = status;
  putBytes(packet, 23, radians(49.0));
  putBytes(packet, 31, radians(8.4));
  putBytes(packet, 39, 110.5F);
  putLittle(packet, 43, static_cast<std::uint64_t>(-70711), 3);
  putLittle(packet, 46, 70711, 3);
  putLittle(packet, 52, 2356194, 3);  // 135 deg
  putLittle(packet, 55, static_cast<std::uint64_t>(-17453), 3);
  std::uint8_t sum = 0;
  for (std::size_t i = 1; i < 61; ++i) sum = static_cast<std::uint8_t>(sum + packet[i]);
  packet[61] = static_cast<char>(sum);
  return packet;
}

TEST(Ncom, APacketSaysPlaceVelocityAndHeading) {
  const auto state = ncomState(ncomPacket('\4'));
  ASSERT_TRUE(state);
  EXPECT_NEAR(state->latitude, 49, 1e-12);
  EXPECT_NEAR(state->altitude, 110.5, 1e-6);
  EXPECT_NEAR(state->north, -7.0711, 1e-9);
  EXPECT_NEAR(state->pitch, -1, 1e-4);
  const auto observation = ncomObservation(Stamp{kNcomBegin}, *state);
  const auto fix =
      gnssFix(dynamic_cast<const mrpt::obs::CObservationGPS&>(*observation), GnssParams());
  ASSERT_TRUE(fix);
  EXPECT_NEAR(fix->place.longitude, 8.4, 1e-12);
  EXPECT_NEAR(fix->velocity.x(), 7.0711, 1e-6);
  EXPECT_NEAR(*fix->yaw, radians(-45), 1e-5);
}

TEST(Ncom, ASystemThatIsNotLockedSaysNoPlaceAndADamagedPacketIsRefused) {
  EXPECT_FALSE(ncomState(ncomPacket('\3')));
  std::string packet = ncomPacket('\4');
  packet[30] = static_cast<char>(packet[30] ^ 1);
  EXPECT_THROW(ncomState(packet), std::runtime_error);
  EXPECT_THROW(ncomState(ncomPacket('\4').substr(1)), std::runtime_error);
  EXPECT_THROW(ncomState(""), std::runtime_error);
}

class NcomInRecording : public test::ImportRun {};

/// A message of CDR: header.
std::string insHeader(std::int64_t stamp) {
  std::string bytes("\0\1\0\0", 4);
  const auto put = [&](std::uint64_t value) {
    bytes.append(4, '\0');
    putLittle(bytes, bytes.size() - 4, value, 4);
  };
  put(static_cast<std::uint64_t>(stamp / 1'000'000'000));
  put(static_cast<std::uint64_t>(stamp % 1'000'000'000));
  put(4);
  return bytes + std::string("ins\0", 4);
}

std::string insText(const std::string& text) {
  std::string length(4, '\0');
  putLittle(length, 0, text.size(), 4);
  return length + text;
}

/// Header, then the packet; no definition travels with it.
std::string ncomMessage(std::int64_t stamp, const std::string& packet) {
  return insHeader(stamp) + insText(packet);
}

TEST_F(NcomInRecording, PacketsOfOxtsBecomeReadingsOfSatellites) {
  McapWriter writer(file("drive.mcap"), "ros2");
  const auto ncom = writer.addChannel("/ins/ncom", "cdr", {"oxts_msgs/msg/Ncom", "ros2msg", ""});
  const auto scan = writer.addChannel("/radar", "cdr", {"radar_msgs/msg/RadarScan", "ros2msg", ""});
  for (int k = 0; k < 5; ++k) {
    const std::int64_t stamp = kNcomBegin + k * 100'000'000;
    writer.write(ncom, Stamp{stamp}, ncomMessage(stamp, ncomPacket(k == 2 ? '\2' : '\4')));
    // A radar's list without a return has the same bytes as no packet.
    writer.write(scan, Stamp{stamp}, ncomMessage(stamp, ""));
  }
  writer.close();
  ASSERT_EQ(import("bag", {"--bag", file("drive.mcap")}), 3) << error_;  // places are not known
  int fixes = 0;
  for (const auto& o : readLog()) {
    const auto* const gps = dynamic_cast<const mrpt::obs::CObservationGPS*>(o.get());
    if (gps != nullptr && gnssFix(*gps, GnssParams())) ++fixes;
  }
  EXPECT_EQ(fixes, 4);
}

TEST_F(NcomInRecording, AnInspvaThatIsAlignedSaysVelocityAndHeadingToo) {
  McapWriter writer(file("drive.mcap"), "ros2");
  const auto ins = writer.addChannel(
      "/inspva", "cdr",
      {"novatel_gps_msgs/msg/Inspva", "ros2msg",
       "std_msgs/Header header\nfloat64 latitude\nfloat64 longitude\nfloat64 height\n"
       "float64 north_velocity\nfloat64 east_velocity\nfloat64 up_velocity\nfloat64 roll\n"
       "float64 pitch\nfloat64 azimuth\nstring status\n"});
  const auto scan = writer.addChannel("/radar", "cdr", {"radar_msgs/msg/RadarScan", "ros2msg", ""});
  for (int k = 0; k < 5; ++k) {
    const std::int64_t stamp = kNcomBegin + k * 100'000'000;
    std::string bytes = insHeader(stamp);
    for (const double value : {49.0, 8.4, 110.0, -7.0, 7.0, 0.1, 0.5, -1.0, 135.0})
      bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    bytes += insText(std::string(k == 2 ? "INS_ALIGNING" : "INS_SOLUTION_GOOD") + '\0');
    writer.write(ins, Stamp{stamp}, bytes);
    writer.write(scan, Stamp{stamp}, ncomMessage(stamp, ""));
  }
  writer.close();
  ASSERT_EQ(import("bag", {"--bag", file("drive.mcap")}), 3) << error_;
  int places = 0, headings = 0;
  for (const auto& o : readLog()) {
    const auto* const gps = dynamic_cast<const mrpt::obs::CObservationGPS*>(o.get());
    const auto fix = gps == nullptr ? std::nullopt : gnssFix(*gps, GnssParams());
    if (!fix) continue;
    ++places;
    EXPECT_NEAR(fix->place.latitude, 49, 1e-9);
    if (!fix->yaw) continue;
    ++headings;
    EXPECT_NEAR(*fix->yaw, radians(-45), 1e-9);
    EXPECT_NEAR(fix->velocity.x(), 7, 1e-5);
    EXPECT_NEAR(fix->velocity.y(), -7, 1e-5);
  }
  EXPECT_EQ(places, 5);
  EXPECT_EQ(headings, 4);
}

}  // namespace
}  // namespace perception
