#include "libperception/simulation/weather/particles/FallingParticles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libperception/simulation/cameras/CameraBoxes.h"

namespace perception {
namespace {

CameraView blackView() {
  CameraView view;
  view.T_world_camera = makePose(0, 0, 1.5, 0) * opticalAxes();
  view.camera.width = 620, view.camera.height = 180;
  view.camera.fx = view.camera.fy = 360, view.camera.cx = 310, view.camera.cy = 90;
  const std::size_t pixels = 620 * 180;
  view.linear.assign(pixels, Eigen::Vector3f::Zero());
  view.range.assign(pixels, CameraView::kSky);
  return view;
}

constexpr double kGlow = 1e-3;  // so dark that light adds up

FallingParticles hanging(const SizeDistribution& sizes) {
  return {sizes, [](double) { return 0.0; },
          [](const Vector3&, double) { return Rgb::Constant(kGlow); }};
}

double coveredPixels(const CameraView& view) {
  double sum = 0;
  for (const auto& value : view.linear)
    sum += view.light.radianceOf(value.cast<double>()).y() / kGlow;
  return sum;
}

/// Of all particles that fill kFaintest of the pixels that the lens of 2 mm spreads them over: the
/// integral over depth and diameter of their number times pi/4 (f D / z)^2.
double expectedPixels(const CameraModel& camera, const SizeDistribution& sizes) {
  const double f = camera.fx, section = camera.width * camera.height / (f * f);
  double sum = 0;
  for (double z = .3; z < 40; z += .01) {
    for (double d = .005; d < 8; d += .01) {  // [mm]
      const double side = f * 1e-3 * d / z, width = std::max(1.0, f * (1e-3 * d + .002) / z);
      if (side * side < kFaintest * width * width) continue;
      sum += .01 * .01 * sizes.number * std::exp(-sizes.slope * d) * section * z * z * kPi / 4 *
             side * side;
    }
  }
  return sum;
}

TEST(FallingParticles, CoverWhatTheirSizesSay) {
  for (SizeDistribution sizes : {flakeSizes(2.5), marshallPalmer(50)}) {
    sizes.number /= 10;  // so few that they do not hide each other
    double covered = 0;
    constexpr int kImages = 20;
    for (std::uint64_t k = 0; k < kImages; ++k) {
      CameraView view = blackView();
      Rng rng({3, k, 0, 0});
      EXPECT_GT(drawParticles(hanging(sizes), view, rng), 100u);
      covered += coveredPixels(view) / kImages;
    }
    EXPECT_NEAR(covered / expectedPixels(blackView().camera, sizes), 1, 0.05);
  }
}

TEST(FallingParticles, SurfacesHideThoseBehind) {
  CameraView view = blackView();
  std::fill(view.range.begin(), view.range.end(), 0.2F);
  Rng rng({3, 0, 0, 0});
  drawParticles(hanging(flakeSizes(2.5)), view, rng);
  EXPECT_EQ(coveredPixels(view), 0);
}

TEST(FallingParticles, TheSameSeedGivesTheSameBytes) {
  CameraView first = blackView(), second = blackView(), other = blackView();
  Rng a({3, 0, 0, 0}), b({3, 0, 0, 0}), c({4, 0, 0, 0});
  drawParticles(hanging(flakeSizes(2.5)), first, a);
  drawParticles(hanging(flakeSizes(2.5)), second, b);
  drawParticles(hanging(flakeSizes(2.5)), other, c);
  EXPECT_EQ(first.linear, second.linear);
  EXPECT_NE(first.linear, other.linear);
}

// Long streaks are faint: most drops of a wide shutter are lost.
TEST(FallingParticles, AFasterFallShowsFewerDrops) {
  CameraView slow = blackView(), fast = blackView();
  FallingParticles drops = hanging(marshallPalmer(50));
  Rng a({3, 0, 0, 0}), b({3, 0, 0, 0});
  const std::size_t hang = drawParticles(drops, slow, a);
  drops.fall_speed = dropSpeed;
  fast.light.exposure_time = 0.02;
  EXPECT_LT(2 * drawParticles(drops, fast, b), hang);
}

TEST(FallingParticles, FallAsMeasured) {
  EXPECT_NEAR(dropSpeed(1), 4.0, 0.05);  // [atlas1973]
  EXPECT_NEAR(dropSpeed(5), 9.14, 0.05);
  EXPECT_EQ(dropSpeed(0.05), 0);
}

}  // namespace
}  // namespace perception
