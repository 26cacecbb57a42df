#include "libperception/pipeline/health/WindowDirt.h"

#include <gtest/gtest.h>

#include "tests/support/DirtyWindow.h"
#include "tests/support/StartStamp.h"

namespace perception {
namespace {

using test::road;

using test::kStart;

TEST(WindowDirt, TheShareIsThatOfThePatches) {
  for (const double dirty : {0.0, 0.1, 0.3}) {
    WindowDirt window;
    for (int k = 0; k <= 12; ++k) window.add(road(dirty), kStart + 0.1 * k);
    ASSERT_TRUE(window.share().has_value());
    EXPECT_NEAR(*window.share(), dirty, 0.06);
  }
}

TEST(WindowDirt, LessThanASecondSaysNothing) {
  WindowDirt window;
  for (int k = 0; k <= 8; ++k) window.add(road(0), kStart + 0.1 * k);
  EXPECT_FALSE(window.share().has_value());
}

TEST(WindowDirt, CountsTheReturnsOfTheRoadOfOneScan) {
  WindowDirt window;
  window.add(road(0), kStart);
  const auto clean = static_cast<double>(window.returns());
  window.add(road(0.3), kStart + 0.1);
  EXPECT_GT(clean, 1000);
  EXPECT_NEAR(static_cast<double>(window.returns()) / clean, 0.7, 0.06);
}

}  // namespace
}  // namespace perception
