#include "libperception/simulation/cameras/CameraView.h"

#include <gtest/gtest.h>

#include <cmath>

namespace perception {
namespace {

CameraView grayView(double linear, int width = 200, int height = 100) {
  CameraView view;
  view.camera.width = width, view.camera.height = height;
  view.camera.fx = view.camera.fy = 150;
  view.camera.cx = .5 * width - .5, view.camera.cy = .5 * height - .5;
  const auto pixels = static_cast<std::size_t>(width * height);
  view.linear.assign(pixels, Eigen::Vector3f::Constant(static_cast<float>(linear)));
  view.range.assign(pixels, CameraView::kSky);
  return view;
}

TEST(CameraView, PixelsAndRaysAreInverses) {
  CameraView view = grayView(0);
  for (const auto projection :
       {CameraModel::Projection::kPinhole, CameraModel::Projection::kEquirectangular}) {
    view.camera.projection = projection;
    const auto pixel = view.pixelOf(7 * view.ray(31, 64));
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x(), 31, 1e-9);
    EXPECT_NEAR(pixel->y(), 64, 1e-9);
  }
  view.camera.projection = CameraModel::Projection::kPinhole;
  EXPECT_FALSE(view.pixelOf({0, 0, -1}));
}

// Poisson statistics of 20,000 / gain electrons in a full pixel, and 10 of reading it.
TEST(CameraView, NoiseIsThatOfElectrons) {
  CameraView view = grayView(0.2);
  view.light.gain = 20;
  Rng rng({1, 2, 0, 0});
  addSensorNoise(view, rng);
  double sum = 0, squares = 0;
  for (const auto& value : view.linear) {
    const double charge =
        view.light.exposure * view.light.radianceOf(value.cast<double>()).x() * 1000;
    sum += charge, squares += charge * charge;
  }
  const auto n = static_cast<double>(view.linear.size());
  const double expected = -std::log(1 - 0.2) * 1000, mean = sum / n;
  EXPECT_NEAR(mean / expected, 1, 0.01);
  EXPECT_NEAR((squares / n - mean * mean) / (expected + 100), 1, 0.05);
}

TEST(CameraView, ByDayNoNoiseIsAdded) {
  CameraView view = grayView(0.2);
  Rng rng({1, 2, 0, 0});
  addSensorNoise(view, rng);
  EXPECT_EQ(view.linear, grayView(0.2).linear);
}

TEST(CameraView, BytesAreBlueGreenRed) {
  CameraView view = grayView(0, 1, 1);
  view.linear[0] = {1, 0, static_cast<float>(linearOf(77))};
  EXPECT_EQ(rasterOf(view).pixels, (std::vector<std::uint8_t>{77, 0, 255}));
}

}  // namespace
}  // namespace perception
