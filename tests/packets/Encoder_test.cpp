// Packets of simulated devices, decoded again.
#include "libperception/packets/Encoder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "libperception/core/Error.h"
#include "libperception/packets/FrameAssembler.h"
#include "libperception/packets/lidars/Ibeo.h"
#include "tests/packets/Candump.h"

namespace perception {
namespace {

constexpr double kPeriod = 0.1;
constexpr std::int64_t kEncodedStart = 1700000000000000000;

/// A room's wall at 5 + azimuth / 20 deg m, seen every half degree by 16 beams from -15 to 15 deg.
SensorFrame room(std::int64_t stamp) {
  LidarCloud cloud;
  for (int beam = 0; beam < 16; ++beam) {
    for (int i = 0; i < 720; ++i) {
      const double azimuth = radians(i * 0.5 - 180), up = radians(2 * beam - 15);
      const double range = 5 + (i * 0.5) / 20;
      cloud.x.push_back(static_cast<float>(range * std::cos(up) * std::cos(azimuth)));
      cloud.y.push_back(static_cast<float>(range * std::cos(up) * std::sin(azimuth)));
      cloud.z.push_back(static_cast<float>(range * std::sin(up)));
      cloud.intensity.push_back(0.5F);
      cloud.ring.push_back(static_cast<std::uint16_t>(beam));
      cloud.label.push_back(
          static_cast<std::uint8_t>(i % 2 == 0 ? PointLabel::kGround : PointLabel::kRain));
      cloud.echo.push_back(static_cast<std::uint8_t>(i % 3));
      cloud.pulse_width.push_back(0.01F * static_cast<float>(i));
    }
  }
  SensorFrame frame;
  frame.stamp = {stamp};
  frame.data = cloud;
  return frame;
}

std::string ousterFile() {
  const std::string path = testing::TempDir() + "/simulated ouster.json";
  std::string altitudes, azimuths;
  for (int i = 0; i < 16; ++i) {
    altitudes += (i > 0 ? "," : "") + std::to_string(15 - 2 * i);
    azimuths += (i > 0 ? "," : "") + std::to_string(i % 2 == 0 ? 3.1 : -3.1);
  }
  std::ofstream(path)
      << R"({"beam_altitude_angles":[)" << altitudes << R"(],"beam_azimuth_angles":[)" << azimuths
      << R"(],"lidar_origin_to_beam_origin_mm":15.8,"data_format":)"
      << R"({"pixels_per_column":16,"columns_per_frame":1024,"columns_per_packet":16}})";
  return path;
}

struct Sent {
  std::vector<SensorFrame> frames;
  std::size_t packets = 0;
  PacketLedger ledger;
  std::vector<std::string> warnings;
  ClockLedger clock;
};

/// Frames 0.1 s apart through encoder and decoder. `without`: the packet that is not sent.
Sent passThrough(const std::string& kind_name, const std::function<SensorFrame(std::int64_t)>& make,
                 const std::string& file = "", std::size_t without = SIZE_MAX) {
  Sent sent;
  const DeviceKind& kind = deviceKind(kind_name);
  const auto encoder = kind.makeEncoder(file);
  FrameAssembler assembler(kind, file, "S", Pose3::Identity(),
                           [&](SensorFrame&& frame) { sent.frames.push_back(std::move(frame)); });
  for (int i = 0; i < 5; ++i) {
    const std::int64_t stamp = kEncodedStart + i * 100000000;
    for (const TimedPacket& packet : encoder->encode(make(stamp), kPeriod)) {
      EXPECT_LE(packet.after, kPeriod + 1e-9);
      if (sent.packets++ != without) assembler.add(packet.payload, Stamp{stamp} + packet.after);
    }
  }
  assembler.finish();
  sent.ledger = assembler.ledger();
  sent.warnings = assembler.warnings();
  sent.clock = assembler.clock();
  return sent;
}

std::string fileOf(const std::string& kind) { return kind == "ouster" ? ousterFile() : ""; }

TEST(Velodyne, ASimulatedVlp32cIsDecodedAsOne) {
  const Sent sent = passThrough("velodyne", &room, "VLP-32C");
  ASSERT_GE(sent.frames.size(), 4U);
  EXPECT_EQ(sent.ledger.lost + sent.ledger.damaged, 0U);
  EXPECT_NEAR(static_cast<double>(sent.packets), 0.5 / 12 / 55.296e-6, 1.5);
  EXPECT_THROW(deviceKind("velodyne").makeEncoder("VLP-64"), ConfigError);
}

class Lidars : public testing::TestWithParam<const char*> {};

TEST_P(Lidars, SeeTheRoomAsItIs) {
  const std::string file = fileOf(GetParam());
  const Sent sent = passThrough(GetParam(), &room, file);
  EXPECT_TRUE(sent.warnings.empty()) << sent.warnings.front();
  EXPECT_EQ(sent.ledger.lost + sent.ledger.damaged + sent.ledger.repeated, 0U);
  EXPECT_EQ(sent.ledger.received, sent.packets);
  ASSERT_GE(sent.frames.size(), 4U);
  // The second turn is whole.
  const auto& cloud = std::get<LidarCloud>(sent.frames[1].data);
  EXPECT_GT(cloud.size(), 2000U);
  double worst = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double azimuth =
        std::atan2(static_cast<double>(cloud.y[i]), static_cast<double>(cloud.x[i])) * 180 / M_PI +
        180;
    const double range = std::hypot(std::hypot(cloud.x[i], cloud.y[i]), cloud.z[i]);
    if (azimuth < 1 || azimuth > 359) continue;  // the wall's seam
    worst = std::max(worst, std::abs(range - 5 - azimuth / 20));
  }
  EXPECT_LT(worst, 0.03);  // half a firing, .1 to .2 deg, of a wall of 1 m in 20 deg; and the unit
  if (GetParam() != std::string("velodyne")) {
    ASSERT_TRUE(sent.clock.offset);
    EXPECT_NEAR(*sent.clock.offset, 0, 0.002);
  }
}

TEST_P(Lidars, ALostPacketIsMissedExactly) {
  if (GetParam() == std::string("rs16")) GTEST_SKIP() << "sends no numbers of its packets";
  const Sent sent = passThrough(GetParam(), &room, fileOf(GetParam()), 77);
  EXPECT_EQ(sent.ledger.lost, 1U);
  EXPECT_EQ(sent.ledger.received, sent.packets - 1);
}

INSTANTIATE_TEST_SUITE_P(Devices, Lidars,
                         testing::Values("velodyne", "pandar40p", "xt32", "rs16", "ouster"));

TEST(Ibeo, ScansKeepLabelsEchoesAndPulseWidths) {
  const Sent sent = passThrough("ibeo", [](std::int64_t stamp) {
    SensorFrame frame = room(stamp);
    auto& cloud = std::get<LidarCloud>(frame.data);
    for (std::size_t i = 0; i < cloud.size(); ++i) {  // on its four layers
      const double up = radians(kIbeoLayers[cloud.ring[i] % 4]);
      const double range = std::hypot(std::hypot(cloud.x[i], cloud.y[i]), cloud.z[i]);
      const double azimuth = std::atan2(cloud.y[i], cloud.x[i]);
      cloud.x[i] = static_cast<float>(range * std::cos(up) * std::cos(azimuth));
      cloud.y[i] = static_cast<float>(range * std::cos(up) * std::sin(azimuth));
      cloud.z[i] = static_cast<float>(range * std::sin(up));
    }
    return frame;
  });
  ASSERT_EQ(sent.frames.size(), 5U);
  EXPECT_TRUE(sent.warnings.empty()) << sent.warnings.front();
  EXPECT_EQ(sent.clock.state, ClockState::kSynchronized);
  const auto& cloud = std::get<LidarCloud>(sent.frames[2].data);
  const SensorFrame made = room(kEncodedStart);
  const auto& truth = std::get<LidarCloud>(made.data);
  ASSERT_EQ(cloud.size(), truth.size());
  EXPECT_EQ(cloud.label, truth.label);
  EXPECT_EQ(cloud.echo, truth.echo);
  for (std::size_t i = 0; i < cloud.size(); i += 7) {
    EXPECT_NEAR(cloud.pulse_width[i], truth.pulse_width[i], 0.006);
    EXPECT_EQ(cloud.ring[i], truth.ring[i] % 4);
    EXPECT_NEAR(std::hypot(std::hypot(cloud.x[i], cloud.y[i]), cloud.z[i]),
                std::hypot(std::hypot(truth.x[i], truth.y[i]), truth.z[i]), 0.006);
    EXPECT_NEAR(wrapAngle(std::atan2(cloud.y[i], cloud.x[i]) - std::atan2(truth.y[i], truth.x[i])),
                0, 3e-4);
    EXPECT_LE(cloud.time_offset[i], 0.026);
    EXPECT_GE(cloud.time_offset[i], -0.076);
  }
}

TEST(Ibeo, AStreamIsCutIntoMessagesAndGoesOnAfterATornOne) {
  const std::string a = ibeoMessage(IbeoType::kLuxScan, kEncodedStart, 0, std::string(50, 'a'));
  const std::string b = ibeoMessage(IbeoType::kEcuScan, kEncodedStart, 0, std::string(70, 'b'));
  const std::string torn = b.substr(0, 40);
  const std::string all = "noise" + a + torn + b + a;
  for (const std::size_t step : {1UL, 7UL, 30UL, all.size()}) {
    IbeoStream stream;
    std::vector<std::string> messages;
    for (std::size_t at = 0; at < all.size(); at += step)
      for (auto& message : stream.add(std::string_view(all).substr(at, step)))
        messages.push_back(message);
    EXPECT_EQ(messages, (std::vector<std::string>{a, torn, b, a})) << step;
    EXPECT_EQ(stream.skipped(), 5U);
  }
  EXPECT_EQ(stampOfNtp(ntpOf(kEncodedStart + 123456789)), kEncodedStart + 123456789);
}

TEST(Ibeo, ReadsTheScansOfEcuAndAlasca) {
  const auto decoder = deviceKind("ibeo").make("");
  // One point of an ECU: 1, 2, 3 m, width .5 m, layer 2, echo 1, 100 us after the start; rain.
  std::string body(24 + 28, '\0');
  const auto put = [&](std::size_t at, const char* bytes, std::size_t size) {
    body.replace(at, size, bytes, size);
  };
  put(8, "\0\0\x03\xE8", 4);  // it took 1000 us
  put(12, "\0\0\0\7", 4);
  put(16, "\0\x11\0\1", 4);
  put(24, "\x3F\x80\0\0\x40\0\0\0\x40\x40\0\0\x3F\0\0\0\1\2\1\0\0\0\0\x64\0\4", 26);
  const DecodedPacket ecu =
      decoder->decode(ibeoMessage(IbeoType::kEcuScan, kEncodedStart, 0, body));
  ASSERT_EQ(ecu.returns.size(), 1U);
  EXPECT_EQ(*ecu.number, 17U);
  const LidarReturn& p = ecu.returns[0];
  EXPECT_EQ(p.x, 1);
  EXPECT_EQ(p.y, 2);
  EXPECT_EQ(p.z, 3);
  EXPECT_EQ(p.pulse_width, 0.5F);
  EXPECT_EQ(p.ring, 2);
  EXPECT_EQ(p.echo, 1);
  EXPECT_EQ(p.time_us, -900);
  EXPECT_EQ(p.label, static_cast<std::uint8_t>(PointLabel::kRain));
  // ALASCA XT: a point at 20 m by the coarse steps behind 100 m ... 190 m, -1 m, .5 m, ground.
  std::string old("\xAF\xFE\xC0\xC0\0\0\0\x1C\0\0\0\x0F\0\0\0\1", 16);
  old += std::string("\1\3\0\0\0\0\0\x64\0\0\0\0\0\5\0\1", 16);
  old += std::string("\0\1\0\3\x2A\x94\xFF\x9C\0\x32\0\x14", 12);  // 10900 -> 190 m
  const DecodedPacket alasca = decoder->decode(old);
  ASSERT_EQ(alasca.returns.size(), 1U);
  EXPECT_NEAR(alasca.returns[0].x, 190, 1e-3);
  EXPECT_NEAR(alasca.returns[0].y, -1, 1e-3);
  EXPECT_NEAR(alasca.returns[0].z, 0.5, 1e-3);
  EXPECT_NEAR(alasca.returns[0].pulse_width, 0.2, 1e-3);
  EXPECT_EQ(alasca.returns[0].label, static_cast<std::uint8_t>(PointLabel::kGround));
}

SensorFrame radarScan(std::int64_t stamp) {
  RadarReturns scan;
  for (int i = 0; i < 20; ++i) {
    RadarReturn r;
    r.range = 3 + 4.3 * i;
    r.bearing = radians(i - 10);
    r.range_rate = 0.37 * i - 3;
    r.amplitude = i;
    scan.returns.push_back(r);
  }
  SensorFrame frame;
  frame.stamp = {stamp};
  frame.data = scan;
  return frame;
}

TEST(Radars, TargetsAreDecodedAsTheyWereSent) {
  struct Steps {
    const char* kind;
    double range, bearing, rate, power;
  };
  for (const Steps& d :
       {Steps{"ars548", 1e-4, 1e-5, 1e-5, .5}, Steps{"srr520", .0123, .0031, .0074, .24},
        Steps{"esr", .051, .0009, .0051, .5}, Steps{"ars408", .15, .08, .25, .3}}) {
    const Sent sent = passThrough(d.kind, &radarScan);
    EXPECT_TRUE(sent.warnings.empty()) << sent.warnings.front();
    ASSERT_EQ(sent.frames.size(), 5U) << d.kind;
    const SensorFrame made = radarScan(kEncodedStart);
    const auto& truth = std::get<RadarReturns>(made.data).returns;
    const auto& got = std::get<RadarReturns>(sent.frames[3].data).returns;
    ASSERT_EQ(got.size(), truth.size()) << d.kind;
    for (std::size_t i = 0; i < got.size(); ++i) {
      EXPECT_NEAR(got[i].range, truth[i].range, d.range) << d.kind;
      EXPECT_NEAR(got[i].bearing, truth[i].bearing, d.bearing) << d.kind;
      EXPECT_NEAR(got[i].range_rate, truth[i].range_rate, d.rate) << d.kind;
      EXPECT_NEAR(got[i].amplitude, truth[i].amplitude, d.power) << d.kind;
    }
  }
}

TEST(Radars, AMissingMessageOfAnEsrIsTold) {
  const Sent sent = passThrough("esr", &radarScan, "", 80);  // a track of the second scan
  ASSERT_EQ(sent.frames.size(), 5U);
  ASSERT_EQ(sent.warnings.size(), 1U);
  EXPECT_NE(sent.warnings[0].find("scan 1: 1 of 64 track messages are missing"), std::string::npos);
  EXPECT_EQ(std::get<RadarReturns>(sent.frames[1].data).returns.size(), 19U);
}

TEST(Radars, AnSrr520WithoutOneElementIsLeftOutAlone) {
  const Sent sent = passThrough("srr520", &radarScan, "", 60);
  EXPECT_EQ(sent.frames.size(), 4U);
  ASSERT_EQ(sent.warnings.size(), 1U);
  EXPECT_NE(sent.warnings[0].find("checksum"), std::string::npos);
}

TEST(Radars, ObjectsAndClustersOfAnArs408ComeFromCandumpText) {
  // Sensor 2. Object 7: DistLong 40.0 m = 2700, DistLat 3.0 m = 1038, VrelLong -6.25 m/s = 487,
  // VrelLat 0 = 256, RCS 12 dBm2 = 152. Cluster 8: DistLat 3.1 m = 527.
  for (const auto& [head, element, y] :
       {std::tuple("62A#01000500", "62B#0754640E79E00098", 3.0),
        std::tuple("620#0100000500", "721#0854620F79E00098", 3.1)}) {
    const std::string text = element;
    const auto decoder = deviceKind("ars408").make("");
    const auto take = [&](const std::string& frame) {
      return decoder->decode(test::candump::parseCandump("(1.0) can0 " + frame)->message);
    };
    EXPECT_FALSE(take(text).ends_scan) << "a list that began before";
    EXPECT_FALSE(take(head).ends_scan);
    EXPECT_FALSE(take("60B#0000000000000000").ends_scan) << "another sensor";
    const DecodedPacket scan = take(text);
    ASSERT_TRUE(scan.ends_scan);
    EXPECT_EQ(*scan.number, 5U);
    ASSERT_EQ(scan.targets.size(), 1U);
    const PacketTarget& target = scan.targets[0];
    EXPECT_NEAR(target.range, std::hypot(40, y), 1e-3);
    EXPECT_NEAR(target.azimuth, std::atan2(y, 40), 1e-4);
    EXPECT_NEAR(target.range_rate, -6.25 * 40 / std::hypot(40, y), 1e-3);
    EXPECT_NEAR(target.rcs, 12, 1e-6);
    EXPECT_THROW(take("62B#0011"), DataError);
  }
}

TEST(Radars, AListOfAnArs408WithoutAnElementEndsWithTheNextAndIsTold) {
  const Sent sent = passThrough("ars408", &radarScan, "", 3);
  ASSERT_EQ(sent.frames.size(), 5U);
  ASSERT_EQ(sent.warnings.size(), 1U);
  EXPECT_NE(sent.warnings[0].find("fewer elements than announced"), std::string::npos);
}

TEST(Radars, TracksOfAnEsrComeFromCandumpText) {
  // Layout of the public DBC: track 3 (0x502) updated, 10.0 deg to the right, 50.0 m, -5.00 m/s.
  const std::string track = "(1.0) can0 502#006321F40000FE0C";
  const auto decoder = deviceKind("esr").make("");
  const auto take = [&](const std::string& line) {
    return decoder->decode(test::candump::parseCandump(line)->message);
  };
  take("(1.0) can0 4E0#0000000007000000");
  take(track);
  for (int g = 0; g < 9; ++g)
    EXPECT_FALSE(take("(1.0) can0 540#0" + std::to_string(g) + "00001400000000").ends_scan);
  const DecodedPacket scan = take("(1.0) can0 540#0900000000000000");
  EXPECT_TRUE(scan.ends_scan);
  EXPECT_EQ(*scan.number, 7U);
  ASSERT_EQ(scan.targets.size(), 1U);
  EXPECT_EQ(scan.targets[0].id, 3);
  EXPECT_NEAR(scan.targets[0].range, 50.0, 0.01);
  EXPECT_NEAR(scan.targets[0].azimuth, radians(-10), 1e-4);
  EXPECT_NEAR(scan.targets[0].range_rate, -5, 1e-3);
  EXPECT_NEAR(scan.targets[0].rcs, 10, 1e-6);
  EXPECT_THROW(take("(1.0) can0 502#0011"), DataError);
}

TEST(Clock, OneThatIsSetIsToldAndCostsNoPacket) {
  const Sent sent = passThrough("xt32", [](std::int64_t stamp) {
    SensorFrame frame = room(stamp);
    if (stamp >= kEncodedStart + 300000000) frame.stamp = frame.stamp + 7.0;
    return frame;
  });
  EXPECT_EQ(sent.clock.steps, 1U);
  EXPECT_NEAR(*sent.clock.offset, -7, 0.01);
  ASSERT_EQ(sent.warnings.size(), 1U);
  EXPECT_NE(sent.warnings[0].find("its clock was set by +7.0"), std::string::npos);
  EXPECT_EQ(sent.ledger.lost, 0U);
}

}  // namespace
}  // namespace perception
