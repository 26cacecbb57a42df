#include "libperception/detectors/panorama/PanoramaFit.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "libperception/core/math/Angle.h"
#include "libperception/detectors/panorama/Panorama.h"

namespace perception {
namespace {

CameraModel sphere(int width, int height, double horizon) {
  CameraModel c;
  c.projection = CameraModel::Projection::kEquirectangular;
  c.width = width, c.height = height;
  c.fx = c.fy = width / kTwoPi;
  c.cx = 0.5 * width - 0.5;
  c.cy = horizon;
  return c;
}

/// White with a dark rectangle, gray.
Raster board(const CameraModel& c, int x1, int y1, int x2, int y2) {
  Raster r{c.width, c.height, 1, {}};
  r.pixels.assign(static_cast<std::size_t>(c.width * c.height), 255);
  for (int y = y1; y < y2; ++y)
    for (int x = x1; x < x2; ++x) r.pixels[static_cast<std::size_t>(y * c.width + x)] = 0;
  return r;
}

ObjectDetection darkBox(const Raster& r) {
  ObjectDetection d;
  d.image_box = ObjectDetection::ImageBox{1e9, 1e9, -1e9, -1e9};
  auto& b = *d.image_box;
  for (int y = 0; y < r.height; ++y) {
    for (int x = 0; x < r.width; ++x) {
      if (r.pixels[static_cast<std::size_t>(y * r.width + x)] > 127) continue;
      b = {std::min(b.x1, x - .5), std::min(b.y1, y - .5), std::max(b.x2, x + .5),
           std::max(b.y2, y + .5)};
    }
  }
  return d;
}

TEST(PanoramaFit, PartOfASphereComesBackToItsPlace) {
  for (const auto& c : {sphere(1001, 300, 120), sphere(1024, 512, 255.5), sphere(1500, 420, 200.5),
                        sphere(1003, 501, 250)}) {
    const PanoramaFit fit(c);
    EXPECT_EQ(fit.width() % Panorama::kTiles, 0);
    const Raster whole = fit.whole(board(c, 310, 130, 350, 170));
    ASSERT_EQ(whole.width, fit.width());
    ASSERT_EQ(whole.height, fit.width() / 2);
    std::vector<ObjectDetection> found{darkBox(whole)};
    // The horizon lies in the middle.
    const double rows = fit.width() / static_cast<double>(c.width);
    EXPECT_NEAR(found[0].image_box->y1 - 0.25 * fit.width() + 0.5, rows * (129.5 - c.cy), 1.5);
    fit.toPicture(found);
    EXPECT_NEAR(found[0].image_box->x1, 309.5, 0.6);
    EXPECT_NEAR(found[0].image_box->y1, 129.5, 1);
    EXPECT_NEAR(found[0].image_box->x2, 349.5, 0.6);
    EXPECT_NEAR(found[0].image_box->y2, 169.5, 1);
  }
}

TEST(PanoramaFit, OnlyAWholeSphereOfTheRightSizeStaysAsItIs) {
  EXPECT_TRUE(PanoramaFit(sphere(2048, 1024, 511.5)).isWhole());
  EXPECT_TRUE(PanoramaFit(Panorama(2048).camera()).isWhole());
  EXPECT_FALSE(PanoramaFit(sphere(2048, 1000, 499.5)).isWhole());
  EXPECT_FALSE(PanoramaFit(sphere(2048, 1024, 480)).isWhole());
  EXPECT_FALSE(PanoramaFit(sphere(2050, 1025, 512)).isWhole());
}

TEST(PanoramaFit, AFootBelowTheLastRowIsCutOffByIt) {
  const PanoramaFit fit(sphere(1024, 200, 99.5));
  ObjectDetection low, beyond;
  low.image_box = ObjectDetection::ImageBox{10, 300, 40, 400};  // rows 156 to 355 are there
  beyond.image_box = ObjectDetection::ImageBox{10, 380, 40, 430};
  std::vector<ObjectDetection> found{low, beyond};
  fit.toPicture(found);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].image_box->y2, 200);
  EXPECT_NEAR(found[0].image_box->y1, 144, 1e-9);
}

}  // namespace
}  // namespace perception
