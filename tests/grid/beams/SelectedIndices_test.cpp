#include "libperception/grid/beams/SelectedIndices.h"

#include <gtest/gtest.h>

#include <vector>

#include "libperception/core/math/Random.h"

namespace perception {
namespace {

TEST(SelectedIndices, PlacesOfMarksInTheirOrder) {
  Rng random({5, 0, 0, 1});
  for (const double share : {0.0, 0.05, 0.5, 1.0}) {
    std::uint8_t marks[SelectedIndices::kMost];
    std::vector<std::size_t> expected;
    for (std::size_t i = 0; i < SelectedIndices::kMost; ++i) {
      marks[i] = random.uniform(0, 1) < share;
      if (marks[i] != 0) expected.push_back(i);
    }
    SelectedIndices chosen;
    chosen.find(marks, SelectedIndices::kMost);
    EXPECT_EQ(std::vector<std::size_t>(chosen.begin(), chosen.end()), expected);
    chosen.find(marks, 8);
    EXPECT_LE(chosen.size(), 8U);
  }
}

}  // namespace
}  // namespace perception
