#include "libperception/scene/files/NumberFormat.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace perception {
namespace {

TEST(NumberFormat, ZeroHasNoSign) {
  EXPECT_EQ(fixedPlaces(-0.00004, 4), "0.0000");
  EXPECT_EQ(fixedPlaces(-0.0, 2), "0.00");
  EXPECT_EQ(fixedPlaces(-0.00006, 4), "-0.0001");
  EXPECT_EQ(fixedPlaces(-10.0, 1), "-10.0");
}

TEST(NumberFormat, RoundsAsExactArithmeticDoes) {
  const auto exact = [](double value, int places) {
    std::string text = fmt::format("{:.{}f}", value, places);
    if (text.find_first_not_of("-0.") == std::string::npos && text[0] == '-') text.erase(0, 1);
    return text;
  };
  std::vector<double> values = {0,     0.5,  1.5,  2.5,    0.125,   1.005,
                                2.675, 0.45, 1e-7, 9.9995, 9.99951, 99999.9999999,
                                1e9,   1e10, 1e15, 1e300,  4e-324};
  std::mt19937 random(1);
  std::uniform_real_distribution<double> exponent(-8, 12), factor(1, 10);
  for (int k = 0; k < 20000; ++k) values.push_back(factor(random) * std::pow(10, exponent(random)));
  for (int k = 0; k < 20000; ++k) {  // near ties
    const double tie = (std::floor(1e4 * factor(random)) + 0.5) / 1000;
    values.push_back(tie), values.push_back(std::nextafter(tie, 0));
  }
  for (const double value : values)
    for (int places = 0; places <= 8; ++places)
      for (const double v : {value, -value}) EXPECT_EQ(fixedPlaces(v, places), exact(v, places));
  EXPECT_EQ(fixedPlaces(std::numeric_limits<double>::infinity(), 3), "inf");
  EXPECT_EQ(fixedPlaces(std::numeric_limits<double>::quiet_NaN(), 3), "nan");
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
