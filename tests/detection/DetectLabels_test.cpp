#include "libperception/detection/DetectLabels.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

TEST(DetectLabels, KittisUnknownAngleIsNoHeading) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "000000.txt")
      << "Car 0.0 0 -10 100 100 200 200 1.5 1.7 4.0 1 1.6 10 -10\n"
         "Car 0.0 0 -1.25 300 100 400 200 1.5 1.7 4.0 1 1.6 10 -1.2\n";
  const auto boxes = ImageLabels(folder / "", LabelRules{40, 0.3, 1}).of("000000.png");
  ASSERT_EQ(boxes.size(), 2u);
  EXPECT_FALSE(boxes[0].heading.has_value());
  ASSERT_TRUE(boxes[1].heading.has_value());
  EXPECT_NEAR(*boxes[1].heading, -1.25, 1e-12);
}

}  // namespace
}  // namespace perception
