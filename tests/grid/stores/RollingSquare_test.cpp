#include "libperception/grid/stores/RollingSquare.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace perception {
namespace {

constexpr std::int64_t kCells = 7;

TEST(RollingSquare, RowsComeInTheirOrder) {
  const RollingSquare square(kCells);
  for (std::int64_t x = -20; x < 20; ++x) {
    std::vector<std::size_t> slots;
    square.forRow(x, -3, kCells, [&](std::size_t slot, std::size_t count) {
      for (std::size_t i = 0; i < count; ++i) slots.push_back(slot + i);
    });
    ASSERT_EQ(slots.size(), static_cast<std::size_t>(kCells));
    for (std::int64_t i = 0; i < kCells; ++i)
      EXPECT_EQ(slots[static_cast<std::size_t>(i)], square.slotOf(x + i, -3));
  }
}

TEST(RollingSquare, WhatEntersIsWhatWasNotHeldBefore) {
  const RollingSquare square(kCells);
  for (std::int64_t dx = -9; dx <= 9; ++dx)
    for (std::int64_t dy = -9; dy <= 9; ++dy) {
      const CellIndex old{-4, 11, 0}, now{old.x + dx, old.y + dy, 0};
      std::multiset<std::size_t> expected, entering;
      for (std::int64_t y = now.y; y < now.y + kCells; ++y)
        for (std::int64_t x = now.x; x < now.x + kCells; ++x)
          if (!square.holds(old, x, y)) expected.insert(square.slotOf(x, y));
      square.forEntering(old, now, [&](std::size_t slot, std::size_t count) {
        for (std::size_t i = 0; i < count; ++i) entering.insert(slot + i);
      });
      EXPECT_EQ(entering, expected) << dx << ", " << dy;
    }
}

}  // namespace
}  // namespace perception
