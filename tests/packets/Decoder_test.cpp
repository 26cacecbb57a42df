#include "libperception/packets/Decoder.h"

#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "libperception/core/Error.h"
#include "libperception/packets/lidars/Ibeo.h"
#include "libperception/packets/radars/CanBundle.h"
#include "tests/packets/Recorded.h"

namespace perception {
namespace {

/// A packet of the device that its decoder takes, without any return.
std::string packetOf(const std::string& kind) {
  std::string bytes;
  if (kind == "velodyne") {
    bytes.assign(1206, '\1');
    for (std::size_t b = 0; b < 12; ++b) bytes.replace(100 * b, 2, "\xFF\xEE");
    bytes.replace(1204, 2, "\x39\x22");
  } else if (kind == "pandar40p") {
    bytes.assign(1262, '\1');
    for (std::size_t b = 0; b < 10; ++b) bytes.replace(124 * b, 2, "\xFF\xEE");
    bytes[1254] = '\x39';
  } else if (kind == "xt32") {
    bytes.assign(1080, '\1');
    bytes.replace(0, 10, std::string("\xEE\xFF\6\1\0\0\x20\x08\1\4", 10));
    bytes[1062] = '\x39';
  } else if (kind == "rs16" || kind == "rs32" || kind == "bpearl" || kind.rfind("helios", 0) == 0) {
    bytes.assign(1248, '\1');
    bytes.replace(0, 8, "\x55\xAA\x05\x0A\x5A\xA5\x50\xA0");
    if (kind.rfind("helios", 0) == 0) bytes.replace(0, 4, "\x55\xAA\x05\x5A");
    bytes[30] = kind == "rs16" ? '\1' : kind == "rs32" ? '\2' : '\3';
    for (std::size_t b = 0; b < 12; ++b) bytes.replace(42 + 100 * b, 2, "\xFF\xEE");
  } else if (kind == "ouster") {
    bytes.assign(16 * (16 + 32 * 12 + 4), '\1');
    for (std::size_t c = 0; c < 16; ++c) bytes.replace(c * 404 + 400, 4, "\xFF\xFF\xFF\xFF");
  } else if (kind == "ars548") {
    bytes.assign(35336, '\1');
    bytes.replace(2, 6, std::string("\1\x50\0\0\x8A\0", 6));
    bytes.replace(35309, 4, std::string("\0\0\1\0", 4));
  } else if (kind == "ibeo") {
    std::string body(44 + 50 * 10, '\1');
    body.replace(28, 2, std::string("\x32\0", 2));
    bytes = ibeoMessage(IbeoType::kLuxScan, 1600000000000000000, 0, body);
  } else if (kind == "esr") {
    bytes = canMessage(0x540, "\1\x62\3\4\5\6\7\x10");
  } else if (kind == "ars408") {
    bytes = canMessage(0x60B, "\1\62\3\4\5\6\7\10");
  } else {
    bytes = std::string("\0\0\3\x84", 4) + std::string(32, '\1');
  }
  return bytes;
}

std::string fileOf(const DeviceKind& kind) {
  if (!kind.needs_file) return "";
  const std::string path = testing::TempDir() + "/ouster metadata.json";
  std::string angles = "1";
  for (int i = 1; i < 32; ++i) angles += "," + std::to_string(i);
  std::ofstream(path) << "{\"beam_altitude_angles\":[" << angles << "],\"beam_azimuth_angles\":["
                      << angles
                      << "],\"data_format\":{\"pixels_per_column\":32,\"columns_per_frame\":1024,"
                         "\"columns_per_packet\":16}}";
  return path;
}

/// Of a CAN bus, on which a list comes with its last frame: two counts of a byte (ARS 408).
constexpr std::size_t kLongestList = 510;

TEST(Decoder, MutatedPacketsAreDecodedOrRefused) {
  std::mt19937 random(1);
  for (const DeviceKind& kind : deviceKinds()) {
    const auto decoder = kind.make(fileOf(kind));
    const std::string sound = packetOf(kind.name);
    ASSERT_NO_THROW(decoder->decode(sound)) << kind.name;
    int refused = 0, decoded = 0;
    for (int i = 0; i < 10000; ++i) {
      std::string bytes = sound;
      for (auto changes = random() % 10 + 1; changes-- > 0;)
        bytes[random() % bytes.size()] = static_cast<char>(random());
      if (random() % 4 == 0) bytes.resize(random() % (bytes.size() + 100));
      if (random() % 2 == 0) bytes.resize(std::min<std::size_t>(bytes.size(), sound.size()));
      try {
        const DecodedPacket packet = decoder->decode(bytes);
        EXPECT_LE(packet.returns.size() + packet.targets.size() + packet.objects.size(),
                  kind.transport == Transport::kCan ? kLongestList : bytes.size());
        ++decoded;
      } catch (const DataError&) {
        ++refused;
      }
    }
    // A frame of another identifier is another's.
    EXPECT_GT(refused, kind.transport == Transport::kCan ? 100 : 500) << kind.name;
    EXPECT_GT(decoded, 500) << kind.name;
  }
}

DecodedPacket numbered(std::uint64_t number) {
  DecodedPacket packet;
  packet.number = number;
  packet.numbers = 65536;
  return packet;
}

TEST(SequenceCounter, ListsWhatIsMissing) {
  SequenceCounter counter;
  for (const std::uint64_t n : {65534, 65535, 2, 3, 6}) EXPECT_TRUE(counter.count(numbered(n)));
  EXPECT_EQ(counter.ledger().lost, 4U);
  EXPECT_TRUE(counter.count(numbered(4)));   // late
  EXPECT_FALSE(counter.count(numbered(4)));  // again
  EXPECT_TRUE(counter.count(numbered(0)));
  EXPECT_EQ(counter.ledger().lost, 2U);
  EXPECT_EQ(counter.ledger().late, 2U);
  EXPECT_EQ(counter.ledger().repeated, 1U);
  EXPECT_EQ(counter.ledger().received, 8U);
  EXPECT_EQ(counter.lostRanges(), (std::vector<std::string>{"1", "5"}));
}

TEST(SequenceCounter, LossesWithoutEndKeepTheirFirstRangesAndTheirCount) {
  SequenceCounter counter;
  std::uint64_t number = 0;
  for (int i = 0; i < 20000; ++i, number += 2) counter.count(numbered(number % 65536));
  EXPECT_EQ(counter.ledger().lost, 19999U);
  const std::vector<std::string> ranges = counter.lostRanges();
  ASSERT_EQ(ranges.size(), 1000U);
  EXPECT_EQ(ranges.front(), "1");
  EXPECT_EQ(ranges.back(), "1999");
  EXPECT_TRUE(counter.count(numbered((number - 501) % 65536)));  // late, and still known as lost
  EXPECT_EQ(counter.ledger().lost, 19998U);
}

TEST(SequenceCounter, ADeviceThatStartsAnewLosesNothing) {
  SequenceCounter counter;
  const auto stamped = [](std::uint64_t number, std::int64_t stamp) {
    DecodedPacket packet = numbered(number);
    packet.stamp_ns = stamp;
    return packet;
  };
  for (int i = 0; i < 500; ++i)
    EXPECT_TRUE(counter.count(stamped(static_cast<std::uint64_t>(i), i)));
  EXPECT_FALSE(counter.count(stamped(499, 499)));  // the same packet again
  for (int i = 0; i < 5000; ++i) {
    EXPECT_TRUE(counter.count(stamped(static_cast<std::uint64_t>(i), 1000 + i)));
  }
  EXPECT_EQ(counter.ledger().restarts, 1U);
  EXPECT_TRUE(counter.count(stamped(0, 9000)));  // from far
  EXPECT_EQ(counter.ledger().restarts, 2U);
  EXPECT_EQ(counter.ledger().lost, 0U);
  EXPECT_EQ(counter.ledger().repeated, 1U);
}

TEST(DeviceKinds, AnUnknownOneIsToldWhichThereAre) {
  try {
    deviceKind("vlp64");
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("xt32"), std::string::npos);
  }
}

}  // namespace
}  // namespace perception
