#include "libperception/grid/stores/ColumnAges.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace perception {
namespace {

TEST(ColumnAges, AColumnKeepsWhatItsAgeLeavesIt) {
  ColumnAges ages(10, 5);
  ages.advance(0.1), ages.touch(3);
  for (int scan = 0; scan < 20; ++scan) ages.advance(0.1);
  EXPECT_NEAR(ages.keep(3), std::exp(-2.0 / 5), 1e-12);
  EXPECT_NEAR(ages.keep(4), std::exp(-2.1 / 5), 1e-12);
  EXPECT_EQ(ages.loss(3), LogOddsColumn::lossOf(ages.keep(3)));
}

TEST(ColumnAges, NoColumnIsOlderThanARoundOfScans) {
  constexpr std::size_t kColumns = 90000;
  ColumnAges ages(kColumns, 5);
  std::vector<int> touched(kColumns, 0);
  int oldest = 0;
  for (int scan = 1; scan <= 1000; ++scan) {
    ages.advance(0.1);
    ages.refresh([&](std::size_t column) {
      oldest = std::max(oldest, scan - touched[column]);
      EXPECT_NEAR(ages.keep(column), std::exp(-0.1 * (scan - touched[column]) / 5), 1e-9);
      touched[column] = scan, ages.touch(column);
    });
  }
  EXPECT_LT(oldest, 256);
  EXPECT_GT(*std::min_element(touched.begin(), touched.end()), 1000 - 256);
}

}  // namespace
}  // namespace perception
