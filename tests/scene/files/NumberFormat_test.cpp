#include "libperception/scene/files/NumberFormat.h"

#include <gtest/gtest.h>

#include <limits>

namespace perception {
namespace {

TEST(NumberFormat, ZeroHasNoSign) {
  EXPECT_EQ(fixedPlaces(-0.00004, 4), "0.0000");
  EXPECT_EQ(fixedPlaces(-0.0, 2), "0.00");
  EXPECT_EQ(fixedPlaces(-0.00006, 4), "-0.0001");
  EXPECT_EQ(fixedPlaces(-10.0, 1), "-10.0");
}

TEST(NumberFormat, SecondsAreExactToTheNanosecond) {
  EXPECT_EQ(decimalSeconds(0), "0.000000000");
  EXPECT_EQ(decimalSeconds(1700000000123456789), "1700000000.123456789");
  EXPECT_EQ(decimalSeconds(-1), "-0.000000001");
  EXPECT_EQ(decimalSeconds(-1500000000), "-1.500000000");
  EXPECT_EQ(decimalSeconds(std::numeric_limits<std::int64_t>::min()), "-9223372036.854775808");
}

TEST(NumberFormat, SecondsReadBackExactly) {
  for (const std::int64_t ns :
       {std::int64_t{0}, std::int64_t{-1}, std::int64_t{999999999},
        std::int64_t{1700000000123456789}, std::numeric_limits<std::int64_t>::max(),
        -std::numeric_limits<std::int64_t>::max()}) {
    std::int64_t read = 42;
    ASSERT_TRUE(parseDecimalSeconds(decimalSeconds(ns), read));
    EXPECT_EQ(read, ns);
  }
  std::int64_t read = 0;
  EXPECT_TRUE(parseDecimalSeconds("3", read));
  EXPECT_EQ(read, 3000000000);
  EXPECT_TRUE(parseDecimalSeconds("-3.5", read));
  EXPECT_EQ(read, -3500000000);
}

TEST(NumberFormat, RefusesWhatIsNoTime) {
  for (const char* text :
       {"", "-", ".", ".5", "5.", "1,5", "1e3", "nan", " 1", "1 ", "1.1234567890", "+1", "1.-5",
        "--1", "9223372036.854775808", "99999999999999999999"}) {
    std::int64_t read = 42;
    EXPECT_FALSE(parseDecimalSeconds(text, read)) << text;
    EXPECT_EQ(read, 42) << text;
  }
}

}  // namespace
}  // namespace perception
