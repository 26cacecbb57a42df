#include "libperception/packets/radars/CanBundle.h"

#include <gtest/gtest.h>

#include "libperception/core/Error.h"
#include "tests/packets/Candump.h"

namespace perception {
namespace {

using test::candump::parseCandump;

TEST(Candump, LinesGiveTheirFrames) {
  const auto classic = parseCandump("(1436509052.249713) vcan0 123#1122AABB R\n");
  ASSERT_TRUE(classic);
  EXPECT_EQ(classic->stamp_ns, 1436509052249713000);
  EXPECT_EQ(classic->interface, "vcan0");
  EXPECT_EQ(classic->message, std::string("\0\0\1\x23\x11\x22\xAA\xBB", 8));
  const auto fd = parseCandump("(1436509052.249713500) can1 12345678##1AA.BB.cc");
  ASSERT_TRUE(fd);
  EXPECT_EQ(fd->stamp_ns, 1436509052249713500);
  EXPECT_EQ(fd->message, "\x12\x34\x56\x78\xAA\xBB\xCC");
  EXPECT_EQ(parseCandump("(1.5) can0 123#1122334455667788_9")->message.size(), 12U);
  EXPECT_FALSE(parseCandump(""));
  EXPECT_FALSE(parseCandump("(1.5) can0 123#R4"));       // remote: no data
  EXPECT_FALSE(parseCandump("(1.5) can0 20000001#00"));  // error frame
}

TEST(Candump, OtherLinesAreRefused) {
  for (const char* line : {"123#11", "(1.5) can0", "(x) can0 123#11", "(1.5) can0 12#11",
                           "(1.5) can0 123#1", "(1.5) can0 123#1G", "(1.5) can0 123##",
                           "(1.5) can0 123#112233445566778899", "(99999999999999999999) can0 123#"})
    EXPECT_THROW(parseCandump(line), DataError) << line;
}

TEST(CanBundle, IsReadAsItWasWritten) {
  const CanBundle bundle{
      200,
      {canMessage(0x500, "12345678"), canMessage(901, std::string(64, 'x')), canMessage(1, "")}};
  const std::string bytes = canBundle(bundle);
  const CanBundle read = parseCanBundle(bytes);
  EXPECT_EQ(read.number, 200);
  EXPECT_EQ(read.messages, bundle.messages);
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_THROW(parseCanBundle(std::string_view(bytes).substr(0, size)), DataError) << size;
}

}  // namespace
}  // namespace perception
