#include "libperception/vision/Panorama.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libperception/core/Error.h"
#include "libperception/core/Random.h"
#include "libperception/vision/BoxGeometry.h"

namespace perception {
namespace {

using Box = ObjectDetection::ImageBox;

constexpr double kHeight = 2.5;  // [m] of the camera: the paper's stands above the roof lidar

Pose3 cameraPose() {
  Pose3 pose = makePose(0, 0, kHeight, 0);
  pose.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return pose;
}

/// A dark post of radius .3 m and height 1.7 m on the ground, at a bearing (counter-clockwise) and
/// a distance of its axis [m].
struct Post {
  double bearing = 0, distance = 0;
};

constexpr double kRadius = 0.3, kTop = 1.7;
constexpr int kSamples = 4;  // per pixel and direction

/// Whether the ray of azimuth `right` [rad, clockwise] and elevation `below` the horizon hits it.
bool hits(const Post& post, double right, double below) {
  const double off = wrapAngle(-right - post.bearing), across = post.distance * std::sin(off);
  if (std::cos(off) <= 0 || std::abs(across) > kRadius) return false;
  const double along =
      post.distance * std::cos(off) - std::sqrt(kRadius * kRadius - across * across);
  const double z = kHeight - along * std::tan(below);
  if (z >= 0 && z <= kTop) return true;
  // Over its upper rim onto the lid.
  const double lid = (kHeight - kTop) / std::tan(below);
  return below > 0 && lid >= along && lid <= 2 * post.distance * std::cos(off) - along;
}

/// A white panorama with the post in it.
Raster render(const Panorama& panorama, const Post& post) {
  const CameraModel& c = panorama.camera();
  Raster image{c.width, c.height, 1, {}};
  image.pixels.assign(static_cast<std::size_t>(c.width) * static_cast<std::size_t>(c.height), 255);
  const double half = std::asin(kRadius / post.distance);
  const double middle = -post.bearing * c.fx + c.cx;
  const int reach = static_cast<int>(half * c.fx) + 3;
  for (int i = -reach; i <= reach; ++i) {
    const int column = static_cast<int>(std::lround(middle)) + i;
    const int u = ((column % c.width) + c.width) % c.width;
    for (int v = c.height / 2 - 2; v < 3 * c.height / 4; ++v) {  // all of it is below the camera
      int covered = 0;  // of the pixel's area, as an optical sensor averages
      for (int k = 0; k < kSamples * kSamples; ++k) {
        const double du = (k % kSamples + 0.5) / kSamples - 0.5;
        const double dv = (k / kSamples + 0.5) / kSamples - 0.5;
        covered += hits(post, (u + du - c.cx) / c.fx, (v + dv - c.cy) / c.fy);
      }
      image.pixels[static_cast<std::size_t>(v) * static_cast<std::size_t>(c.width) +
                   static_cast<std::size_t>(u)] =
          static_cast<std::uint8_t>(255 - 255 * covered / (kSamples * kSamples));
    }
  }
  return image;
}

/// The detector of these tests: the box about all dark pixels.
std::vector<ObjectDetection> detect(const Raster& tile) {
  int x1 = tile.width, y1 = tile.height, x2 = -1, y2 = -1;
  for (int y = 0; y < tile.height; ++y) {
    for (int x = 0; x < tile.width; ++x) {
      if (tile.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(tile.width) +
                      static_cast<std::size_t>(x)] >= 128)
        continue;
      x1 = std::min(x1, x), x2 = std::max(x2, x), y1 = std::min(y1, y), y2 = std::max(y2, y);
    }
  }
  if (x2 < x1) return {};
  ObjectDetection d;
  d.label = "person";
  d.image_box = Box{x1 - 0.5, y1 - 0.5, x2 + 0.5, y2 + 0.5};  // edges of the pixels
  return {d};
}

struct ChainError {
  double range = 0, bearing = 0;  ///< share of the range, [rad]
  int objects = 0;
};

/// Panorama -> tiles -> boxes -> panorama -> suppression -> ground range.
ChainError chainError(const Panorama& panorama, const Post& post) {
  const Raster image = render(panorama, post);
  std::vector<std::vector<ObjectDetection>> found;
  for (int k = 0; k < Panorama::kTiles; ++k) found.push_back(detect(panorama.tile(image, k)));
  const ObjectDetections merged = panorama.merge(found);
  ChainError e;
  e.objects = static_cast<int>(merged.objects.size());
  if (e.objects != 1) return e;
  const auto out =
      boxOnGround(*merged.objects[0].image_box, merged.camera, cameraPose(), {}, {}, {});
  if (!out || !out->range) {
    e.range = 1;
    return e;
  }
  const double truth = post.distance - kRadius;
  e.range = std::abs(*out->range - truth) / truth;
  e.bearing = std::abs(wrapAngle(middleBearing(out->left, out->right) - post.bearing));
  return e;
}

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
  const Panorama panorama(8000);  // the full panorama of the paper
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
  // Two people a metre apart, and a car behind one of them.
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
