#include "libperception/importers/bags/MessageTimes.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace perception {
namespace {

constexpr std::int64_t kAnyBegin = 1'700'000'000'000'000'000;  // [ns]

TEST(MessageTimes, StampsThatRepeatAreUsedOnlyBehindEachOther) {
  const auto usedOf = [](const std::vector<std::int64_t>& tenths) {
    std::vector<MessageTimes> times;
    for (const std::int64_t t : tenths)
      times.push_back({Stamp{kAnyBegin + t * 100'000'000}, Stamp{kAnyBegin}});
    return clockOf(times).used;
  };
  EXPECT_EQ(usedOf({0, 0, 1, 1}), (std::vector<bool>{true, true, true, true}));
  EXPECT_EQ(usedOf({0, 1, 2, 0, 1, 2, 3}),
            (std::vector<bool>{true, true, true, false, false, false, true}));
}

TEST(MessageTimes, ScansAreSentAgainOnlyWhereALidarTurnsBetweenThem) {
  const auto within = [](const std::vector<double>& steps, int times) {
    std::vector<Stamp> stamps = {Stamp{kAnyBegin}};
    for (int i = 0; i < times; ++i)
      for (const double step : steps) stamps.push_back(stamps.back() + step);
    return resentWithin(stamps);
  };
  EXPECT_EQ(within({0.1}, 20), 0.02);
  EXPECT_EQ(within({0.004, 0.096}, 20), 0.02) << "each was passed on once";
  EXPECT_EQ(within({0, 0.1}, 20), 0.02) << "each came twice";
  EXPECT_EQ(within({0.005, 0.005, 0.005, 0.005, 9.98}, 3), 0) << "a world that stands for 20 ms";
  EXPECT_EQ(within({0.005, 9.995}, 5), 0) << "shown twice";
  EXPECT_EQ(within({0.00133}, 100), 0) << "parts of a turn";
}

}  // namespace
}  // namespace perception
