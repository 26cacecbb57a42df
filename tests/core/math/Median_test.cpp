#include "libperception/core/math/Median.h"

#include <gtest/gtest.h>

namespace perception {
namespace {

TEST(Median, IsTheMiddleValueAndTheUpperOneOfTwo) {
  EXPECT_EQ(medianOf(std::vector<double>{7}), 7);
  EXPECT_EQ(medianOf(std::vector<double>{9, 1, 4}), 4);
  EXPECT_EQ(medianOf(std::vector<int>{9, 1, 4, 5}), 5);
}

}  // namespace
}  // namespace perception
