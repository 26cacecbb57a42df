#pragma once
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "libperception/core/math/Random.h"
#include "libperception/detectors/panorama/Panorama.h"
#include "libperception/measurement/models/FootprintModel.h"
#include "libperception/vision/BoxGeometry.h"

// A rendered panorama with one post in it, its tiles, a detector without faults, and the way back
// to bearing and range on the ground.
namespace perception::test {

inline constexpr double kHeight =
    2.5;  // [m] of the camera: the paper's stands above the roof lidar

inline Pose3 cameraPose() {
  Pose3 pose = makePose(0, 0, kHeight, 0);
  pose.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return pose;
}

/// A dark post of radius .3 m and height 1.7 m on the ground, at a bearing (counter-clockwise) and
/// a distance of its axis [m].
struct Post {
  double bearing = 0, distance = 0;
};

inline constexpr double kRadius = 0.3, kTop = 1.7;
inline constexpr int kSamples = 4;  // per pixel and direction

/// Whether the ray of azimuth `right` [rad, clockwise] and elevation `below` the horizon hits it.
inline bool hits(const Post& post, double right, double below) {
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
inline Raster render(const Panorama& panorama, const Post& post) {
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

/// Where the darkest pixel of each row (or column), from the `first` one on, passes half of white:
/// between the centers of two rows.
inline double crossing(const std::vector<int>& darkest, int first, int step) {
  const int before = darkest[static_cast<std::size_t>(first - step)];
  const int at = darkest[static_cast<std::size_t>(first)];
  return first - step * (127.5 - at) / std::max(1, before - at);
}

/// The detector of these tests: the box about what is darker than half, its edges between pixels as
/// a detector without faults would put them.
inline std::vector<ObjectDetection> detect(const Raster& tile) {
  std::vector<int> rows(static_cast<std::size_t>(tile.height), 255);
  std::vector<int> columns(static_cast<std::size_t>(tile.width), 255);
  for (int y = 0; y < tile.height; ++y) {
    for (int x = 0; x < tile.width; ++x) {
      const auto row = static_cast<std::size_t>(y), column = static_cast<std::size_t>(x);
      const int gray = tile.pixels[row * static_cast<std::size_t>(tile.width) + column];
      rows[row] = std::min(rows[row], gray), columns[column] = std::min(columns[column], gray);
    }
  }
  const auto ends = [](const std::vector<int>& darkest) {
    int first = -1, last = -1;
    for (int i = 0; i < static_cast<int>(darkest.size()); ++i) {
      if (darkest[static_cast<std::size_t>(i)] > 127) continue;
      first = first < 0 ? i : first, last = i;
    }
    return std::pair(first, last);
  };
  const auto [top, bottom] = ends(rows);
  const auto [left, right] = ends(columns);
  if (top < 0) return {};
  const auto edge = [](const std::vector<int>& darkest, int at, int step) {
    const int beyond = at - step;
    if (beyond < 0 || beyond >= static_cast<int>(darkest.size())) return at - 0.5 * step;
    return crossing(darkest, at, step);
  };
  ObjectDetection d;
  d.label = "person";
  d.image_box = ObjectDetection::ImageBox{edge(columns, left, 1), edge(rows, top, 1),
                                          edge(columns, right, -1), edge(rows, bottom, -1)};
  return {d};
}

struct ChainError {
  double range = 0, bearing = 0;  ///< share of the range, [rad]; without sign
  double too_far = 0;             ///< share of the range, with it
  double deviations = 0;          ///< error of the range in its own standard deviations
  int objects = 0;
};

/// Where a box at that bearing lies when the vehicle pitches.
inline ObjectDetection::ImageBox pitched(ObjectDetection::ImageBox box, const CameraModel& camera,
                                         double bearing, double nose_down) {
  const double rows = camera.fy * nose_down * std::cos(bearing);
  box.y1 -= rows, box.y2 -= rows;
  return box;
}

/// Panorama -> tiles -> boxes -> panorama -> suppression -> ground range.
/// `nose_down` [rad]: pitch of the vehicle that nobody knows of.
inline ChainError chainError(const Panorama& panorama, const Post& post, double nose_down = 0) {
  const Raster image = render(panorama, post);
  std::vector<std::vector<ObjectDetection>> found;
  for (int k = 0; k < Panorama::kTiles; ++k) found.push_back(detect(panorama.tile(image, k)));
  const ObjectDetections merged = panorama.merge(found);
  ChainError e;
  e.objects = static_cast<int>(merged.objects.size());
  if (e.objects != 1) return e;
  const auto out =
      boxOnGround(pitched(*merged.objects[0].image_box, merged.camera, post.bearing, nose_down),
                  merged.camera, cameraPose(), {}, {}, {});
  if (!out || !out->range) {
    e.range = 1;
    return e;
  }
  const double truth = post.distance - kRadius;
  e.too_far = (*out->range - truth) / truth;
  e.range = std::abs(e.too_far);
  e.deviations = (*out->range - truth) / out->range_sigma;
  e.bearing = std::abs(wrapAngle(middleBearing(out->left, out->right) - post.bearing));
  return e;
}

}  // namespace perception::test
