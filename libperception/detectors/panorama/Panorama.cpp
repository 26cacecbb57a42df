#include "libperception/detectors/panorama/Panorama.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <tuple>

#include "libperception/core/Error.h"

namespace perception {
namespace {

constexpr int kStripMargin = 2;           // [px] margin of the strip for interpolation
constexpr double kBorder = 1.5;           // [px] a box this close to its tile's edge is truncated
constexpr double kCentral = radians(25);  // tiles are 45 degrees apart; some overlap
constexpr double kSameUnion = 0.4;        // method.md 8.8: one object from this overlap on ...
constexpr double kSameSmaller = 0.7;  // ... or when so much of the smaller box lies in the other

using Box = ObjectDetection::ImageBox;

/// A detection in the panorama and the sides at which its tile truncates it.
struct Candidate {
  ObjectDetection object;
  bool left_cut = false, right_cut = false, bottom_cut = false;
  bool off_axis = false;  ///< closer to the middle of another tile, with less distortion
  int cuts() const { return left_cut + right_cut + bottom_cut; }
};

/// The box shifted by full turns so that it begins inside the panorama.
Box normalized(Box box, double width) {
  const double turns = std::floor((box.x1 + 0.5) / width);
  box.x1 -= turns * width;
  box.x2 -= turns * width;
  return box;
}

/// `b` shifted by full turns to be nearest to `a`.
Box besides(const Box& a, Box b, double width) {
  const double turns = std::round((0.5 * (a.x1 + a.x2) - 0.5 * (b.x1 + b.x2)) / width);
  b.x1 += turns * width;
  b.x2 += turns * width;
  return b;
}

/// Whether two truncated boxes are the left and right part of one object.
bool complete(const Candidate& a, const Candidate& b) {
  return (a.right_cut && b.left_cut) || (a.left_cut && b.right_cut);
}

/// Extends the kept box by another view of the same object.
void absorb(Candidate& kept, const Candidate& other, double width) {
  Box& box = *kept.object.image_box;
  if (complete(kept, other)) {
    const Box b = besides(box, *other.object.image_box, width);
    box = {std::min(box.x1, b.x1), std::min(box.y1, b.y1), std::max(box.x2, b.x2),
           std::max(box.y2, b.y2)};
    kept.left_cut = kept.left_cut && other.left_cut;
    kept.right_cut = kept.right_cut && other.right_cut;
  }
  if (other.object.score > kept.object.score) {
    kept.object.score = other.object.score;
    if (other.object.heading) kept.object.heading = other.object.heading;
  }
}

/// One candidate per object: the best view, extended by the others.
std::vector<Candidate> suppress(std::vector<Candidate> candidates, double width) {
  // Complete views before truncated ones (half a car may have the best score) and before views at a
  // tile's edge, where the lowest row is not that of the nearest point (12 cm for a person at 45
  // deg).
  std::stable_sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) {
    return std::make_tuple(a.cuts(), a.off_axis, -a.object.score) <
           std::make_tuple(b.cuts(), b.off_axis, -b.object.score);
  });
  std::vector<Candidate> kept;
  for (const Candidate& c : candidates) {
    const auto same = std::find_if(kept.begin(), kept.end(), [&](const Candidate& k) {
      if (k.object.label != c.object.label) return false;
      const auto overlap = panoramaOverlap(*k.object.image_box, *c.object.image_box, width);
      return overlap.of_union >= kSameUnion || overlap.of_smaller >= kSameSmaller;
    });
    if (same == kept.end()) {
      kept.push_back(c);
    } else {
      absorb(*same, c, width);
    }
  }
  return kept;
}

}  // namespace

/// Source coordinates of each pixel of a tile within its strip of the panorama.
struct Panorama::Maps {
  cv::Mat fixed, weights;
};

Panorama::Panorama(int width) {
  if (width < 64 || width % kTiles != 0)
    throw DataError("a panorama of " + std::to_string(width) +
                    " pixels across: expected a multiple of 8, at least 64");
  camera_.projection = CameraModel::Projection::kEquirectangular;
  camera_.width = width;
  camera_.height = width / 2;
  camera_.fx = camera_.fy = width / kTwoPi;
  camera_.cx = 0.5 * camera_.width - 0.5;
  camera_.cy = 0.5 * camera_.height - 0.5;
  const int size = width / 4;
  tile_camera_.width = tile_camera_.height = size;
  tile_camera_.fx = tile_camera_.fy = 0.5 * size;  // 90 degrees
  tile_camera_.cx = tile_camera_.cy = 0.5 * size - 0.5;

  // Column of the strip's first pixel for tile 0; those of other tiles are offset by whole pixels.
  const double first = 0.5 * camera_.width - 0.5 * size - kStripMargin;
  cv::Mat from_x(size, size, CV_32FC1), from_y(size, size, CV_32FC1);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double xc = (x - tile_camera_.cx) / tile_camera_.fx;
      const double yc = (y - tile_camera_.cy) / tile_camera_.fy;
      const double elevation = std::atan2(yc, std::sqrt(1 + xc * xc));  // below the horizon
      from_x.at<float>(y, x) = static_cast<float>(std::atan(xc) * camera_.fx + camera_.cx - first);
      from_y.at<float>(y, x) = static_cast<float>(elevation * camera_.fy + camera_.cy);
    }
  }
  auto maps = std::make_unique<Maps>();
  cv::convertMaps(from_x, from_y, maps->fixed, maps->weights, CV_16SC2);
  maps_ = std::move(maps);
}

Panorama::~Panorama() = default;
Panorama::Panorama(Panorama&&) noexcept = default;
Panorama& Panorama::operator=(Panorama&&) noexcept = default;

double Panorama::tileAzimuth(int tile) { return wrapAngle(tile * (kTwoPi / kTiles)); }

Raster Panorama::tile(const Raster& panorama, int tile) const {
  const int size = tile_camera_.width, width = camera_.width, channels = panorama.channels;
  const auto bytes = static_cast<std::size_t>(width) * static_cast<std::size_t>(camera_.height) *
                     static_cast<std::size_t>(std::max(channels, 0));
  if (panorama.width != width || panorama.height != camera_.height || bytes == 0 ||
      panorama.pixels.size() != bytes)
    return {};
  const cv::Mat whole(camera_.height, width, CV_8UC(channels),
                      const_cast<std::uint8_t*>(panorama.pixels.data()));
  // The tile's strip, joined across the seam.
  const int shift = ((tile % kTiles) + kTiles) % kTiles * (width / kTiles);
  const int begin = ((width - size) / 2 - kStripMargin + shift) % width;
  const int columns = size + 2 * kStripMargin, before_seam = std::min(columns, width - begin);
  cv::Mat strip(camera_.height, columns, whole.type());
  whole.colRange(begin, begin + before_seam).copyTo(strip.colRange(0, before_seam));
  if (before_seam < columns)
    whole.colRange(0, columns - before_seam).copyTo(strip.colRange(before_seam, columns));
  Raster out;
  out.width = out.height = size;
  out.channels = channels;
  out.pixels.resize(static_cast<std::size_t>(size) * static_cast<std::size_t>(size) *
                    static_cast<std::size_t>(channels));
  cv::Mat target(size, size, whole.type(), out.pixels.data());
  cv::remap(strip, target, maps_->fixed, maps_->weights, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return out;
}

ObjectDetection::ImageBox Panorama::toPanorama(const ObjectDetection::ImageBox& box,
                                               int tile) const {
  const double f = tile_camera_.fx, c = tile_camera_.cx;
  const double left = std::atan((box.x1 - c) / f), right = std::atan((box.x2 - c) / f);
  // Rows are converted at the middle azimuth of the box.
  const double depth = std::hypot(1.0, std::tan(0.5 * (left + right)));
  const auto row = [&](double y) {
    return std::atan2((y - tile_camera_.cy) / tile_camera_.fy, depth) * camera_.fy + camera_.cy;
  };
  const double axis = tileAzimuth(tile);
  Box out{(axis + left) * camera_.fx + camera_.cx, row(box.y1),
          (axis + right) * camera_.fx + camera_.cx, row(box.y2)};
  if (box.y2 >= tile_camera_.height - 1 - kBorder) out.y2 = camera_.height;
  return normalized(out, camera_.width);
}

ObjectDetections Panorama::merge(const std::vector<std::vector<ObjectDetection>>& tiles) const {
  std::vector<Candidate> candidates;
  for (std::size_t k = 0; k < tiles.size(); ++k) {
    for (const ObjectDetection& object : tiles[k]) {
      if (!object.image_box) continue;
      const Box& box = *object.image_box;
      Candidate c;
      c.object = object;
      c.object.image_box = toPanorama(box, static_cast<int>(k));
      c.left_cut = box.x1 <= kBorder;
      c.right_cut = box.x2 >= tile_camera_.width - 1 - kBorder;
      c.bottom_cut = box.y2 >= tile_camera_.height - 1 - kBorder;
      const double f = tile_camera_.fx, middle = tile_camera_.cx;
      const double azimuth =
          0.5 * (std::atan((box.x1 - middle) / f) + std::atan((box.x2 - middle) / f));
      c.off_axis = std::abs(azimuth) > kCentral;
      candidates.push_back(std::move(c));
    }
  }
  // An extended box may overlap another one: repeat until none is merged.
  for (std::size_t before = candidates.size() + 1; candidates.size() < before;) {
    before = candidates.size();
    candidates = suppress(std::move(candidates), camera_.width);
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const auto& a, const auto& b) { return a.object.score > b.object.score; });
  ObjectDetections out;
  out.camera = camera_;
  for (auto& k : candidates) {
    k.object.image_box = normalized(*k.object.image_box, camera_.width);
    out.objects.push_back(std::move(k.object));
  }
  return out;
}

BoxOverlap panoramaOverlap(const ObjectDetection::ImageBox& a, const ObjectDetection::ImageBox& far,
                           double width) {
  const Box b = besides(a, far, width);
  const double w = std::min(a.x2, b.x2) - std::max(a.x1, b.x1);
  const double h = std::min(a.y2, b.y2) - std::max(a.y1, b.y1);
  if (w <= 0 || h <= 0) return {};
  const double area_a = (a.x2 - a.x1) * (a.y2 - a.y1), area_b = (b.x2 - b.x1) * (b.y2 - b.y1);
  return {w * h / (area_a + area_b - w * h), w * h / std::min(area_a, area_b)};
}

}  // namespace perception
