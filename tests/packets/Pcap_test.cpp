#include "libperception/packets/Pcap.h"

#include <gtest/gtest.h>

#include <string>

#include "libperception/core/Error.h"

namespace perception {
namespace {

std::string header() {
  return std::string("\xD4\xC3\xB2\xA1\2\0\4\0", 8) + std::string(12, '\0') +
         std::string("\1\0\0\0", 4);
}

/// A record with a UDP datagram of three bytes; its IPv4 length says `stated`.
std::string record(char stated = 31) {
  std::string frame(14 + 20 + 8 + 3, '\0');
  frame[12] = 8;
  frame[14] = 0x45, frame[17] = stated, frame[23] = 17;
  frame[36] = 9, frame[37] = 0x40, frame[39] = 11;
  frame.replace(42, 3, "abc");
  const std::string size{static_cast<char>(frame.size()), 0, 0, 0};
  return std::string("\2\0\0\0\3\0\0\0", 8) + size + size + frame;
}

TEST(Pcap, ReadsADatagram) {
  const PcapContents contents = parsePcap(header() + record(), "x");
  ASSERT_EQ(contents.packets.size(), 1U);
  EXPECT_EQ(contents.packets[0].payload, "abc");
  EXPECT_EQ(contents.packets[0].port, 2368);
  EXPECT_EQ(contents.packets[0].stamp_ns, 2000003000);
}

TEST(Pcap, LosesOnlyTheDamagedRecord) {
  const PcapContents contents =
      parsePcap(header() + record() + record(99) + record() + record().substr(0, 30), "x");
  EXPECT_EQ(contents.packets.size(), 2U);
  ASSERT_EQ(contents.warnings.size(), 2U);
  EXPECT_NE(contents.warnings[0].find("record 2"), std::string::npos);
  EXPECT_NE(contents.warnings[1].find("torn"), std::string::npos);
}

TEST(Pcap, RefusesOtherFiles) {
  EXPECT_THROW(parsePcap("", "x"), DataError);
  EXPECT_THROW(parsePcap(std::string(24, 'x'), "x"), DataError);
}

}  // namespace
}  // namespace perception
