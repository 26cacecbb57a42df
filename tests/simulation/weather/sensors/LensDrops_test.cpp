#include "libperception/simulation/weather/sensors/LensDrops.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/simulation/cameras/CameraView.h"

namespace perception {
namespace {

/// Black and white columns, which any blur makes gray.
CameraView stripedView() {
  CameraView view;
  view.camera.width = 600, view.camera.height = 200;
  view.camera.fx = view.camera.fy = 360, view.camera.cx = 300, view.camera.cy = 100;
  for (int i = 0; i < 600 * 200; ++i)
    view.linear.push_back(Eigen::Vector3f::Constant(i % 2 ? 1.F : 0.F));
  return view;
}

TEST(LensDrops, BlurTheirShareOfTheImage) {
  for (const double share : {0.05, 0.15}) {
    double blurred = 0;
    constexpr int kImages = 20;
    for (std::uint64_t k = 0; k < kImages; ++k) {
      CameraView view = stripedView();
      Rng rng({1, k, 0, 0});
      addLensDrops(share, view, rng);
      for (std::size_t i = 0; i < view.linear.size(); ++i)
        blurred += 2 * std::abs(view.linear[i].x() - static_cast<float>(i % 2));
    }
    EXPECT_NEAR(blurred / (kImages * 600.0 * 200) / share, 1, 0.1);
  }
}

TEST(LensDrops, ADryLensChangesNothing) {
  CameraView view = stripedView();
  Rng rng({1, 0, 0, 0});
  addLensDrops(0, view, rng);
  EXPECT_EQ(view.linear, stripedView().linear);
}

}  // namespace
}  // namespace perception
