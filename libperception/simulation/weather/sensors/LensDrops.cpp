#include "libperception/simulation/weather/sensors/LensDrops.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "libperception/simulation/cameras/CameraView.h"

namespace perception {
namespace {

// Assumed: drops of 3 to 10 mm at 0.3 m; what is seen through one is spread over its own size, at
// the edge it is mixed with what is beside it.
constexpr double kSmallest = radians(0.3), kLargestLensDrop = radians(1);  // radius
constexpr double kBlur = radians(1.5);                                     // width of the blur
constexpr double kDropEdge = 0.3;                                          // of the radius

double smooth(double x) {
  const double c = std::clamp(x, 0.0, 1.0);
  return c * c * (3 - 2 * c);
}

}  // namespace

// Disks at random places: a Boolean model, which leaves exp(-number times area) uncovered. The soft
// edge counts as covered to its middle.
void addLensDrops(double share, CameraView& view, Rng& rng) {
  if (share <= 0) return;
  const int width = view.camera.width, height = view.camera.height;
  cv::Mat image(height, width, CV_32FC3, view.linear.data());
  cv::Mat blurred;
  const int side = std::max(3, static_cast<int>(std::lround(kBlur * view.camera.fx)) | 1);
  cv::blur(image, blurred, {side, side});
  cv::blur(blurred, blurred, {side, side});
  cv::Mat open(height, width, CV_32F, cv::Scalar(1));  // share of what passes beside the drops
  const double a = kSmallest * view.camera.fx, b = kLargestLensDrop * view.camera.fx;
  const double area = kPi * (a * a + a * b + b * b) / 3;  // mean of disks
  const double margin = (1 + kDropEdge) * b;
  const double field = (width + 2 * margin) * (height + 2 * margin);
  const int drops = rng.poisson(-std::log1p(-share) / area * field);
  for (int k = 0; k < drops; ++k) {
    const double x = rng.uniform(-margin, width + margin),
                 y = rng.uniform(-margin, height + margin);
    const double radius = rng.uniform(a, b), outer = (1 + .5 * kDropEdge) * radius;
    const int top = std::max(0, static_cast<int>(std::floor(y - outer))),
              bottom = std::min(height, static_cast<int>(std::ceil(y + outer)) + 1);
    const int left = std::max(0, static_cast<int>(std::floor(x - outer))),
              right = std::min(width, static_cast<int>(std::ceil(x + outer)) + 1);
    for (int v = top; v < bottom; ++v) {
      for (int u = left; u < right; ++u) {
        const double inside = smooth((outer - std::hypot(u - x, v - y)) / (kDropEdge * radius));
        open.at<float>(v, u) *= static_cast<float>(1 - inside);
      }
    }
  }
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const float o = open.at<float>(v, u);
      auto& pixel = image.at<cv::Vec3f>(v, u);
      pixel = o * pixel + (1 - o) * blurred.at<cv::Vec3f>(v, u);
    }
  }
}

}  // namespace perception
