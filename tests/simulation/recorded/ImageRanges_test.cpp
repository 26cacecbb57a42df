#include "libperception/simulation/recorded/ImageRanges.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/simulation/cameras/CameraBoxes.h"
#include "libperception/simulation/cameras/CameraView.h"

namespace perception {
namespace {

constexpr int kWidth = 400, kHeight = 200;
constexpr double kRangesEye = 1.65;
const Pose3 kPose = makePose(0, 0, kRangesEye, 0) * opticalAxes();

CameraModel camera() {
  CameraModel c;
  c.width = kWidth, c.height = kHeight;
  c.fx = c.fy = 400, c.cx = 199.5, c.cy = 99.5;
  return c;
}

/// A wall across the road, 4 m wide, from the ground to 3 m; columns and rows 8 cm apart.
std::vector<Vector3> wall(double range) {
  std::vector<Vector3> points;
  for (double y = -2; y <= 2; y += .08)
    for (double z = 0; z <= 3; z += .08) points.emplace_back(range, y, z);
  return points;
}

float at(const std::vector<float>& ranges, int u, int v) {
  return ranges[static_cast<std::size_t>(v * kWidth + u)];
}

TEST(ImageRanges, AreThoseOfReturnsRoadAndSky) {
  const std::vector<char> sky(kWidth * kHeight, 1);
  const auto ranges = imageRanges(camera(), kPose, wall(20), sky);
  EXPECT_NEAR(at(ranges, 200, 95), 20, 0.1);
  EXPECT_EQ(at(ranges, 10, 20), CameraView::kSky);
  EXPECT_EQ(at(ranges, 200, 20), CameraView::kSky);  // above the wall
  const double down = (180 - 99.5) / 400;            // of a row on the road before it
  EXPECT_NEAR(at(ranges, 200, 180), kRangesEye / std::sin(std::atan(down)), 0.1);
}

TEST(ImageRanges, WhatIsDarkAboveTheHorizonIsAsFarAsWhatIsBelow) {
  const std::vector<char> sky(kWidth * kHeight, 0);
  const auto ranges = imageRanges(camera(), kPose, wall(20), sky);
  EXPECT_NEAR(at(ranges, 200, 20), 20, 0.3);
  EXPECT_NEAR(at(ranges, 10, 20), 50, 0.3);  // nothing is known
}

TEST(ImageRanges, AHoleInASurfaceIsFilled) {
  std::vector<Vector3> points;
  for (const Vector3& p : wall(20))
    if (std::abs(p.y()) > .5 || std::abs(p.z() - 1.2) > .4) points.push_back(p);
  const auto ranges = imageRanges(camera(), kPose, points, std::vector<char>(kWidth * kHeight, 1));
  EXPECT_NEAR(at(ranges, 199, 108), 20, 0.1);
}

TEST(ImageRanges, EdgesGoWhereTheImageHasThem) {
  std::vector<float> gray, ranges;
  for (int i = 0; i < kWidth * kHeight; ++i) {
    gray.push_back(i % kWidth < 200 ? 0.1F : 0.9F);
    ranges.push_back(i % kWidth < 205 ? 10.F : 40.F);  // five pixels too far to the right
  }
  alignRanges(camera(), gray, ranges);
  EXPECT_NEAR(at(ranges, 150, 100), 10, 0.3);
  EXPECT_NEAR(at(ranges, 197, 100), 10, 1);
  EXPECT_GT(at(ranges, 202, 100), 14);  // 10 before
  EXPECT_NEAR(at(ranges, 250, 100), 40, 1);
}

}  // namespace
}  // namespace perception
