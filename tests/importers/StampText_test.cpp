#include "libperception/importers/StampText.h"

#include <gtest/gtest.h>

namespace perception {
namespace {

constexpr Stamp kTime{1'700'000'000'123'456'789};

TEST(StampText, TheUnitOfAWholeNumberIsFoundFromItsSize) {
  EXPECT_EQ(stampOfSeconds("1700000000.123456789"), kTime);
  EXPECT_EQ(stampOfSeconds("1700000000123456789"), kTime);
  EXPECT_EQ(stampOfSeconds("1700000000123456"), Stamp{kTime.ns / 1000 * 1000});
  EXPECT_EQ(stampOfSeconds("1700000000123"), Stamp{kTime.ns / 1000'000 * 1000'000});
  EXPECT_EQ(stampOfSeconds("1700000000"), Stamp{1'700'000'000'000'000'000});
}

TEST(StampText, NumbersBeyondTheStampsAreNone) {
  for (const char* text :
       {"9000000001", "99999999999", "9999999999999", "99999999999999", "99999999999999999",
        "9223372036854775807", "9223372036854775808", "-1", ""})
    EXPECT_FALSE(stampOfSeconds(text)) << text;
}

TEST(StampText, ADateMayHaveATimeZone) {
  const auto utc = stampOfDate("2023-11-14 22:13:20.123456789");
  EXPECT_EQ(utc, kTime);
  for (const char* text :
       {"2023-11-14T22:13:20.123456789Z", "2023-11-15T00:13:20.123456789+02",
        "2023-11-15 00:13:20.123456789+02:00", "2023-11-14_16:43:20.123456789-0530"})
    EXPECT_EQ(stampOfDate(text), utc) << text;
  for (const char* text :
       {"2023-11-14 22:13:20+", "2023-11-14 22:13:20+2", "2023-11-14 22:13:20+15",
        "2023-11-14 22:13:20+02:60", "2023-11-14 24:13:20"})
    EXPECT_FALSE(stampOfDate(text)) << text;
}

}  // namespace
}  // namespace perception
