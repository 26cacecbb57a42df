#include "libperception/detection/DetectImages.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "libperception/core/Error.h"
#include "libperception/importers/ImportText.h"
#include "libperception/sensors/images/CameraImages.h"
#include "libperception/sensors/images/ImageFile.h"

namespace perception {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kImageEndings{".png", ".jpg", ".jpeg", ".bmp"};

}  // namespace

void DetectCameraParams::visit(ParamVisitor& v) {
  v.real("height", height, {0, 10}, "m", "of the camera over the ground; 0: not known");
  v.angle("pitch_deg", pitch, {-45, 45}, "of the camera, down");
  v.angle("field_of_view_deg", field_of_view, {1, 170}, "across the image");
  v.expert();
  v.real("horizon", horizon, {0, 1e5}, "px",
         "row of the horizon at pitch 0, of panoramas, too; 0: the middle");
  v.choice(
      "panorama", panorama, {"auto", "yes", "no"},
      "the full circle across (equirectangular); auto: twice as wide as high, 1024 px or more, "
      "without calibration");
}

bool isRawlog(const std::string& path) {
  return fs::path(path).extension() == ".rawlog" || fs::path(path).extension() == ".gz";
}

std::vector<std::string> imageFiles(const std::vector<std::string>& inputs) {
  std::vector<std::string> out;
  for (const std::string& input : inputs) {
    if (!fs::is_directory(input)) {
      out.push_back(input);
      continue;
    }
    for (const FrameFile& file : frameFiles(input, kImageEndings)) out.push_back(file.path);
  }
  return out;
}

std::optional<Raster> readImage(const std::string& path) {
  const cv::Mat pixels = readImageFile(path, cv::IMREAD_COLOR);
  if (pixels.empty()) return std::nullopt;
  Raster raster{pixels.cols, pixels.rows, 3, {}};
  for (int y = 0; y < pixels.rows; ++y) {
    const auto* row = pixels.ptr<std::uint8_t>(y);
    raster.pixels.insert(raster.pixels.end(), row, row + pixels.cols * 3);
  }
  return raster;
}

Pose3 cameraPose(double height, double pitch) {
  Pose3 pose = Pose3::Identity();
  const double c = std::cos(pitch), s = std::sin(pitch);
  pose.linear().col(0) = Vector3(0, -1, 0);
  pose.linear().col(1) = Vector3(-s, 0, -c);
  pose.linear().col(2) = Vector3(c, 0, -s);
  pose.translation() = Vector3(0, 0, height);
  return pose;
}

bool isPanorama(const Raster& image, int choice, bool calibrated) {
  return choice == 1 ||
         (choice == 0 && !calibrated && panoramaModel(image.width, image.height).has_value());
}

CameraModel panoramaCamera(const Raster& image, const DetectCameraParams& params,
                           const std::string& name) {
  constexpr int kLeast = 64;  // [px] Panorama's
  if (image.width < kLeast || 2 * image.height > image.width + 1)
    throw DataError(
        fmt::format("{}: {} x {} pixels are no panorama: expected the full circle "
                    "across, {} px or more, and at most half as high",
                    name, image.width, image.height, kLeast));
  CameraModel camera;
  camera.projection = CameraModel::Projection::kEquirectangular;
  camera.width = image.width;
  camera.height = image.height;
  camera.fx = camera.fy = image.width / kTwoPi;
  camera.cx = 0.5 * image.width - 0.5;
  camera.cy = params.horizon > 0 ? params.horizon : 0.5 * image.height - 0.5;
  return camera;
}

CameraModel cameraOf(const Raster& image, const DetectCameraParams& params,
                     const std::string& name) {
  if (isPanorama(image, params.panorama, false)) return panoramaCamera(image, params, name);
  CameraModel camera;
  camera.width = image.width;
  camera.height = image.height;
  camera.cx = 0.5 * image.width - 0.5;
  camera.cy = params.horizon > 0 ? params.horizon : 0.5 * image.height - 0.5;
  camera.fx = camera.fy = 0.5 * image.width / std::tan(0.5 * params.field_of_view);
  return camera;
}

}  // namespace perception
