#include "libperception/simulation/recorded/ImageRanges.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "libperception/simulation/cameras/CameraView.h"

namespace perception {
namespace {

constexpr double kCell = radians(0.4);    // as far apart as the beams of a 64-beam lidar
constexpr int kRangeGap = 5, kHole = 25;  // [cells] filled between returns; on one surface
constexpr double kUnknown = 50;           // [m] above the horizon, without returns (assumed)
constexpr double kSameSurface = 1.3;      // ratio of ranges
constexpr double kOnGround = 0.15;        // share of the range
constexpr double kLevel = 1e-4;           // slope from which on a ray meets the road
constexpr double kWindow = 3;             // [cells] radius of the guided filter
constexpr double kSmooth = 1e-3;          // variance of gray values that counts as an edge
constexpr float kNoRange = 0;

/// Nearest return in each cell of an image.
class Cells {
 public:
  explicit Cells(const CameraModel& camera)
      : side_(std::max(1.0, kCell * camera.fx)),
        width(static_cast<int>(std::ceil(camera.width / side_))),
        height(static_cast<int>(std::ceil(camera.height / side_))),
        range_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), kNoRange) {}

  float& at(int x, int y) {
    return range_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
  }
  int of(double pixel) const { return static_cast<int>(std::floor((pixel + .5) / side_)); }
  void add(const Vector2& pixel, double range) {
    const int x = of(pixel.x()), y = of(pixel.y());
    if (x < 0 || y < 0 || x >= width || y >= height) return;
    float& cell = at(x, y);
    if (cell == kNoRange || range < static_cast<double>(cell)) cell = static_cast<float>(range);
  }

 private:
  double side_;

 public:
  int width, height;

 private:
  std::vector<float> range_;
};

// Along one row or column: 1 / range is linear on a plane; at an edge the nearer neighbor counts.
template <class At>
void fillGaps(int length, const At& at) {
  int last = -1;
  for (int i = 0; i < length; ++i) {
    if (at(i) == kNoRange) continue;
    const int gap = i - last - 1;
    const double a = last < 0 ? 0 : at(last), b = at(i);
    const bool same = std::max(a, b) < kSameSurface * std::min(a, b);
    if (last >= 0 && gap > 0 && gap <= (same ? kHole : kRangeGap)) {
      for (int k = last + 1; k < i; ++k) {
        const double w = static_cast<double>(k - last) / (i - last);
        at(k) = static_cast<float>(same ? 1 / ((1 - w) / a + w / b) : (w < .5 ? a : b));
      }
    }
    last = i;
  }
}

// Uppermost return of each column.
std::vector<float> upperEdge(Cells& cells) {
  std::vector<float> edge(static_cast<std::size_t>(cells.width), static_cast<float>(kUnknown));
  for (int x = 0; x < cells.width; ++x) {
    int y = 0;
    while (y < cells.height && cells.at(x, y) == kNoRange) ++y;
    if (y < cells.height) edge[static_cast<std::size_t>(x)] = cells.at(x, y);
  }
  return edge;
}

}  // namespace

std::vector<float> imageRanges(const CameraModel& camera, const Pose3& T_world_camera,
                               const std::vector<Vector3>& returns, const std::vector<char>& sky) {
  CameraView view;
  view.camera = camera, view.T_world_camera = T_world_camera;
  Cells cells(camera);
  const Pose3 T_camera_world = T_world_camera.inverse();
  for (const Vector3& point : returns) {
    const Vector3 p = T_camera_world * point;
    if (const auto pixel = view.pixelOf(p)) cells.add(*pixel, p.norm());
  }
  for (int x = 0; x < cells.width; ++x)
    fillGaps(cells.height, [&](int y) -> float& { return cells.at(x, y); });
  for (int y = 0; y < cells.height; ++y)
    fillGaps(cells.width, [&](int x) -> float& { return cells.at(x, y); });
  const std::vector<float> edge = upperEdge(cells);

  const double eye = T_world_camera.translation().z();
  std::vector<float> ranges;
  ranges.reserve(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const double down = -view.ray(u, v).z();
      const float seen = cells.at(cells.of(u), cells.of(v));
      if (down > kLevel) {
        const double ground = eye / down;
        const bool road =
            seen == kNoRange || std::abs(ground / static_cast<double>(seen) - 1) < kOnGround;
        ranges.push_back(road ? static_cast<float>(ground) : seen);
      } else if (seen != kNoRange) {
        ranges.push_back(seen);
      } else {
        ranges.push_back(sky[ranges.size()] ? CameraView::kSky
                                            : edge[static_cast<std::size_t>(cells.of(u))]);
      }
    }
  }
  return ranges;
}

void alignRanges(const CameraModel& camera, const std::vector<float>& gray,
                 std::vector<float>& ranges) {
  const cv::Mat guide(camera.height, camera.width, CV_32F, const_cast<float*>(gray.data()));
  cv::Mat inverse(camera.height, camera.width, CV_32F);
  std::transform(ranges.begin(), ranges.end(), inverse.ptr<float>(), [](float r) { return 1 / r; });
  const int side =
      2 * static_cast<int>(std::lround(kWindow * std::max(1.0, kCell * camera.fx))) + 1;
  const auto mean = [&](const cv::Mat& of) {
    cv::Mat result;
    cv::boxFilter(of, result, CV_32F, {side, side}, {-1, -1}, true, cv::BORDER_REFLECT);
    return result;
  };
  const cv::Mat mean_guide = mean(guide), mean_inverse = mean(inverse);
  const cv::Mat covariance = mean(guide.mul(inverse)) - mean_guide.mul(mean_inverse);
  const cv::Mat variance = mean(guide.mul(guide)) - mean_guide.mul(mean_guide);
  const cv::Mat slope = covariance / (variance + kSmooth);
  const cv::Mat offset = mean_inverse - slope.mul(mean_guide);
  const cv::Mat filtered = mean(slope).mul(guide) + mean(offset);
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const float inverse_range = *(filtered.ptr<float>() + i);
    if (ranges[i] < CameraView::kSky) ranges[i] = 1 / std::max(inverse_range, 1 / CameraView::kSky);
  }
}

}  // namespace perception
