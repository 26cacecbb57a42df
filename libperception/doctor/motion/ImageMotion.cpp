#include "libperception/doctor/motion/ImageMotion.h"

#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <utility>
#include <vector>

#include "libperception/core/math/Median.h"

namespace perception {
namespace {

constexpr double kWindow = 0.3;   ///< [s] of a motion: several images
constexpr double kLongest = 0.5;  ///< [s] between two images
constexpr int kWidth = 800;       ///< [px] larger images are reduced to it
constexpr int kCorners = 600;
constexpr double kBack = 0.5;   ///< [px] between a corner and where tracking back leads
constexpr double kMoves = 1.0;  ///< [px] median motion of corners: below, the camera stands
constexpr std::size_t kFewest = 40;

cv::Mat grayOf(const Raster& raster) {
  const cv::Mat pixels(raster.height, raster.width, CV_8UC(raster.channels),
                       const_cast<std::uint8_t*>(raster.pixels.data()));  // only read
  cv::Mat gray;
  if (raster.channels == 3)
    cv::cvtColor(pixels, gray, cv::COLOR_BGR2GRAY);
  else
    gray = pixels.clone();
  if (gray.cols <= kWidth) return gray;
  cv::Mat small;
  cv::resize(gray, small, cv::Size(kWidth, gray.rows * kWidth / gray.cols), 0, 0, cv::INTER_AREA);
  return small;
}

struct Corners {
  std::vector<cv::Point2f> before, after;  ///< [px] in the first image of a motion and in the last
};

Corners cornersOf(const cv::Mat& image) {
  Corners out;
  cv::goodFeaturesToTrack(image, out.before, kCorners, 0.005, 8);
  out.after = out.before;
  return out;
}

/// Follows corners into the next image; those that are lost go.
Corners followed(const Corners& corners, const cv::Mat& before, const cv::Mat& after) {
  Corners out;
  if (corners.after.size() < kFewest) return out;
  std::vector<cv::Point2f> there, back;
  std::vector<std::uint8_t> found, found_back;
  std::vector<float> errors;
  const cv::Size window(21, 21);
  cv::calcOpticalFlowPyrLK(before, after, corners.after, there, found, errors, window, 4);
  cv::calcOpticalFlowPyrLK(after, before, there, back, found_back, errors, window, 4);
  for (std::size_t i = 0; i < there.size(); ++i) {
    const bool lost =
        found[i] == 0 || found_back[i] == 0 || cv::norm(corners.after[i] - back[i]) > kBack;
    if (lost) continue;
    out.before.push_back(corners.before[i]), out.after.push_back(there[i]);
  }
  return out;
}

double medianMotion(const Corners& corners) {
  std::vector<double> ways;
  for (std::size_t i = 0; i < corners.before.size(); ++i)
    ways.push_back(cv::norm(corners.after[i] - corners.before[i]));
  return medianOf(std::move(ways));
}

std::optional<CameraMotion> motionOf(const Corners& corners, const CameraModel& camera,
                                     double scale, Stamp from, Stamp to) {
  const cv::Matx33d K(scale * camera.fx, 0, scale * camera.cx, 0, scale * camera.fy,
                      scale * camera.cy, 0, 0, 1);
  cv::Mat agree, R, t;
  const cv::Mat E =
      cv::findEssentialMat(corners.before, corners.after, K, cv::USAC_MAGSAC, 0.999, 1.0, agree);
  if (E.rows != 3 || E.cols != 3) return std::nullopt;
  const int most = cv::countNonZero(agree);
  if (most < static_cast<int>(kFewest) || 2 * most < static_cast<int>(corners.before.size()))
    return std::nullopt;
  cv::recoverPose(E, corners.before, corners.after, K, R, t, agree);
  CameraMotion out{from, to, {}, {}};
  Eigen::Matrix3d back;  // takes points of the first frame to the second: x2 = back x1 + t
  Vector3 offset;
  cv::cv2eigen(R, back);
  cv::cv2eigen(t, offset);
  out.turn = back.transpose();
  out.travel = -(back.transpose() * offset).normalized();
  return out;
}

}  // namespace

struct ImageMotion::State {
  cv::Mat gray;
  Stamp stamp, from;  ///< of the last image, of the first one of the motion
  Corners corners;
  void start(const cv::Mat& image, Stamp at) {
    gray = image, stamp = from = at;
    corners = cornersOf(image);
  }
};

ImageMotion::ImageMotion() : state_(std::make_unique<State>()) {}
ImageMotion::~ImageMotion() = default;
ImageMotion::ImageMotion(ImageMotion&&) noexcept = default;

std::optional<CameraMotion> ImageMotion::update(const CameraModel& camera, const Raster& image,
                                                Stamp stamp) {
  State& s = *state_;
  const cv::Mat gray = grayOf(image);
  const double dt = stamp - s.stamp;
  if (s.gray.size() != gray.size() || dt <= 0 || dt > kLongest) {
    s.start(gray, stamp);
    return std::nullopt;
  }
  s.corners = followed(s.corners, s.gray, gray);
  s.gray = gray, s.stamp = stamp;
  if (stamp - s.from < kWindow) return std::nullopt;
  const Corners corners = s.corners;
  const Stamp from = s.from;
  s.start(gray, stamp);
  if (corners.before.size() < kFewest || medianMotion(corners) < kMoves) return std::nullopt;
  return motionOf(corners, camera, static_cast<double>(gray.cols) / image.width, from, stamp);
}

}  // namespace perception
