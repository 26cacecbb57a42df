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

}  // namespace
}  // namespace perception
