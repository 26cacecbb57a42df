#include "libperception/detectors/panorama/Panorama.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libperception/core/Error.h"
#include "libperception/core/math/Random.h"
#include "libperception/vision/BoxGeometry.h"
#include "tests/detectors/PanoramaChain.h"

namespace perception {
namespace {

using namespace test;

using Box = ObjectDetection::ImageBox;

TEST(Panorama, ChainOfGeometryAt2k) {
  const Panorama panorama(2048);
  Rng rng({11, 0, 0, 0});
  const int n = 60;
  for (int trial = 0; trial < n; ++trial) {
    const Post post{rng.uniform(-kPi, kPi), rng.uniform(4, 30)};
    const ChainError e = chainError(panorama, post);
    ASSERT_EQ(e.objects, 1) << post.bearing << " " << post.distance;
    // Half a pixel of a tile and of the panorama each.
    EXPECT_LT(e.bearing, kPi / 2048 + 1.0 / 512) << post.bearing;
    EXPECT_LE(e.range, 0.025) << post.bearing << " " << post.distance;  // a pixel is 4.7 % at 30 m
  }
}

TEST(Panorama, ChainOfGeometryAt8k) {
  const Panorama panorama(8192);
  Rng rng({12, 0, 0, 0});
  for (const double distance : {5.0, 12.0, 20.0, 30.0}) {
    const ChainError e = chainError(panorama, {rng.uniform(-kPi, kPi), distance});
    ASSERT_EQ(e.objects, 1);
    EXPECT_LE(e.range, 0.01) << distance;
  }
}

TEST(Panorama, AnUnknownPitchIsInsideTheStatedDeviation) {
  const Panorama panorama(2048);
  Rng rng({13, 0, 0, 0});
  const BoxGeometryParams params;
  double squares = 0;
  constexpr int kTrials = 60;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Post post{rng.uniform(-kPi, kPi), rng.uniform(4, 30)};
    const double pitch = rng.normal(0, std::hypot(params.pitch_sigma, radians(0.3)));
    const ChainError e = chainError(panorama, post, pitch);
    ASSERT_EQ(e.objects, 1);
    EXPECT_LT(std::abs(e.deviations), 4.5) << post.distance;
    squares += e.deviations * e.deviations;
  }
  // At most as large as stated: the chi-square quantile .999 of 60 trials is 99.6.
  EXPECT_LT(squares, 99.6);
  EXPECT_GT(squares, 0.1 * kTrials);  // and not far larger than it needs to be
}

TEST(Panorama, TilesShowWhatThePanoramaHoldsInTheirDirection) {
  // A smooth pattern over the sphere, known everywhere.
  const Panorama panorama(1024);
  const CameraModel& c = panorama.camera();
  const auto pattern = [](double right, double below, int channel) {
    return 128 + 100 * std::sin(2 * right + channel) * std::cos(1.5 * below + channel);
  };
  Raster image{c.width, c.height, 3, {}};
  for (int v = 0; v < c.height; ++v) {
    for (int u = 0; u < c.width; ++u) {
      for (int channel = 0; channel < 3; ++channel)
        image.pixels.push_back(static_cast<std::uint8_t>(
            std::lround(pattern((u - c.cx) / c.fx, (v - c.cy) / c.fy, channel))));
    }
  }
  const CameraModel& t = panorama.tileCamera();
  EXPECT_EQ(t.width, 256);
  EXPECT_NEAR(2 * std::atan(0.5 * t.width / t.fx), kPi / 2, 1e-12);
  for (int k = 0; k < Panorama::kTiles; ++k) {
    const Raster tile = panorama.tile(image, k);
    ASSERT_EQ(tile.width, 256);
    for (int y = 0; y < 256; y += 5) {
      for (int x = 0; x < 256; x += 5) {
        const double xc = (x - t.cx) / t.fx, yc = (y - t.cy) / t.fy;
        const double right = Panorama::tileAzimuth(k) + std::atan(xc);
        const double below = std::atan2(yc, std::hypot(1, xc));
        for (int channel = 0; channel < 3; ++channel) {
          const std::size_t at =
              3 * static_cast<std::size_t>(256 * y + x) + static_cast<std::size_t>(channel);
          // Rounding twice, and the curvature between pixels.
          ASSERT_NEAR(tile.pixels[at], pattern(right, below, channel), 1.6) << k << " " << x;
        }
      }
    }
  }
}

TEST(Panorama, RefusesOtherSizes) {
  EXPECT_THROW(Panorama(1000 + 1), DataError);
  EXPECT_THROW(Panorama(0), DataError);
  const Panorama panorama(8000);  // the full panorama of [radecki2016]
  EXPECT_EQ(panorama.tileCamera().width, 2000);
  Raster other{1024, 512, 3, std::vector<std::uint8_t>(1024 * 512 * 3)};
  EXPECT_TRUE(panorama.tile(other, 0).pixels.empty());
  Raster torn{8000, 4000, 3, std::vector<std::uint8_t>(100)};
  EXPECT_TRUE(panorama.tile(torn, 0).pixels.empty());
}

ObjectDetection found(const char* label, Box box, double score) {
  ObjectDetection d;
  d.label = label, d.score = score, d.image_box = box;
  return d;
}

/// The panorama's box between azimuths (clockwise) and elevations (below the horizon) [rad], as
/// tile `k` sees it, cut at the tile's edges.
Box tileBox(const Panorama& p, int k, double left, double right, double above, double below) {
  const CameraModel& t = p.tileCamera();
  const double a = std::max(wrapAngle(left - Panorama::tileAzimuth(k)), -kPi / 4);
  const double b = std::min(wrapAngle(right - Panorama::tileAzimuth(k)), kPi / 4);
  const double depth = std::hypot(1, std::tan(0.5 * (a + b)));
  const auto x = [&](double angle) {
    return std::clamp(t.cx + t.fx * std::tan(angle), 0.0, t.width - 1.0);
  };
  const auto y = [&](double angle) {
    return std::clamp(t.cy + t.fy * depth * std::tan(angle), 0.0, t.height - 1.0);
  };
  return {x(a), y(above), x(b), y(below)};
}

TEST(Panorama, BoxesKeepTheirAnglesInEveryTile) {
  const Panorama p(2048);
  const CameraModel& c = p.camera();
  for (int k = 0; k < Panorama::kTiles; ++k) {
    const double left = Panorama::tileAzimuth(k) + 0.2, right = left + 0.3;
    const Box box = p.toPanorama(tileBox(p, k, left, right, -0.05, 0.3), k);
    EXPECT_GE(box.x1, -0.5);
    EXPECT_LT(box.x1, c.width);
    EXPECT_NEAR(wrapAngle((box.x1 - c.cx) / c.fx - left), 0, 1e-9);
    EXPECT_NEAR((box.x2 - box.x1) / c.fx, 0.3, 1e-9);
    EXPECT_NEAR((box.y1 - c.cy) / c.fy, -0.05, 1e-9);
    EXPECT_NEAR((box.y2 - c.cy) / c.fy, 0.3, 1e-9);
  }
}

TEST(Panorama, EachObjectIsKeptOnceWithItsBestScore) {
  const Panorama p(2048);
  std::vector<std::vector<ObjectDetection>> tiles(Panorama::kTiles);
  // On the seam, behind the vehicle: tiles 3, 4 and 5 look there; 4 sees it best.
  for (const auto& [k, score] : {std::pair{3, 0.4}, {4, 0.7}, {5, 0.9}}) {
    const Box box = tileBox(p, k, kPi - 0.05, -kPi + 0.05, 0.0, 0.2);
    if (box.x2 > box.x1 + 2) tiles[std::size_t(k)].push_back(found("person", box, score));
  }
  // Two people a meter apart, and a car behind one of them.
  tiles[0].push_back(found("person", tileBox(p, 0, 0.00, 0.06, 0, 0.2), 0.8));
  tiles[0].push_back(found("person", tileBox(p, 0, 0.10, 0.16, 0, 0.2), 0.6));
  tiles[1].push_back(found("person", tileBox(p, 1, 0.10, 0.16, 0, 0.2), 0.5));
  tiles[0].push_back(found("car", tileBox(p, 0, -0.02, 0.08, 0, 0.2), 0.3));
  const ObjectDetections merged = p.merge(tiles);
  ASSERT_EQ(merged.objects.size(), 4u);
  EXPECT_EQ(merged.objects[0].score, 0.9);
  const Box& seam = *merged.objects[0].image_box;
  EXPECT_NEAR((seam.x2 - seam.x1) / p.camera().fx, 0.1, 0.002);
  EXPECT_GT(seam.x2, p.camera().width);
  EXPECT_EQ(merged.objects[3].label, "car");
  EXPECT_EQ(merged.camera.projection, CameraModel::Projection::kEquirectangular);
}

TEST(Panorama, AnObjectWiderThanATilesHalfIsPutTogether) {
  const Panorama p(2048);
  std::vector<std::vector<ObjectDetection>> tiles(Panorama::kTiles);
  // A bus alongside, 110 degrees wide: no tile sees both of its ends.
  const double left = radians(35), right = radians(145);
  for (const int k : {1, 2, 3})
    tiles[std::size_t(k)].push_back(
        found("car", tileBox(p, k, left, right, -0.1, 0.5), 0.5 + 0.1 * k));
  const ObjectDetections merged = p.merge(tiles);
  ASSERT_EQ(merged.objects.size(), 1u);
  const Box& box = *merged.objects[0].image_box;
  EXPECT_NEAR((box.x1 - p.camera().cx) / p.camera().fx, left, 0.01);
  EXPECT_NEAR((box.x2 - p.camera().cx) / p.camera().fx, right, 0.01);
}

TEST(Panorama, AFootBelowTheTileIsNotSeen) {
  const Panorama p(2048);
  const CameraModel& t = p.tileCamera();
  const Box box = p.toPanorama({200, 200, 300, t.height - 1.0}, 0);
  const auto out = boxOnGround(box, p.camera(), cameraPose(), {}, {}, {});
  ASSERT_TRUE(out);
  EXPECT_TRUE(out->left_seen && out->right_seen);
  EXPECT_FALSE(out->range);
}

}  // namespace
}  // namespace perception
