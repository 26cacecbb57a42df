#include "libperception/sensors/images/CameraImages.h"

#include <cstdlib>
#include <exception>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <optional>

#include "libperception/core/math/Angle.h"
#include "libperception/sensors/images/ImageFile.h"

namespace perception {
namespace {

std::optional<Raster> rasterOf(const cv::Mat& pixels) {
  const bool known = pixels.depth() == CV_8U && (pixels.channels() == 1 || pixels.channels() == 3);
  if (pixels.empty() || !known) return std::nullopt;
  Raster raster{pixels.cols, pixels.rows, pixels.channels(), {}};
  const auto row_bytes =
      static_cast<std::size_t>(pixels.cols) * static_cast<std::size_t>(pixels.channels());
  raster.pixels.reserve(row_bytes * static_cast<std::size_t>(pixels.rows));
  for (int y = 0; y < pixels.rows; ++y) {
    const auto* row = pixels.ptr<std::uint8_t>(y);
    raster.pixels.insert(raster.pixels.end(), row, row + row_bytes);
  }
  return raster;
}

std::optional<Raster> loadFile(const std::string& path) {
  std::error_code fault;
  if (!std::filesystem::is_regular_file(path, fault)) return std::nullopt;
  try {
    return rasterOf(readImageFile(path, cv::IMREAD_COLOR));
  } catch (const std::exception&) {  // OpenCV throws on sizes beyond its limits
    return std::nullopt;
  }
}

std::optional<Raster> pixelsOf(const mrpt::img::CImage& image) {
  try {
    if (image.isEmpty()) return std::nullopt;
    return rasterOf(image.asCvMat<cv::Mat>(mrpt::img::SHALLOW_COPY));
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

}  // namespace

std::string imagesBeside(const std::string& log) {
  const std::filesystem::path path(log);
  return (path.parent_path() / (path.stem().string() + "_Images")).string();
}

std::optional<CameraModel> panoramaModel(int width, int height) {
  constexpr int kLeastWidth = 1024;  // [px]
  if (width < kLeastWidth || std::abs(width - 2 * height) > 1) return std::nullopt;
  CameraModel camera;
  camera.projection = CameraModel::Projection::kEquirectangular;
  camera.width = width, camera.height = height;
  camera.fx = camera.fy = width / kTwoPi;
  camera.cx = .5 * width - .5, camera.cy = .5 * height - .5;
  return camera;
}

CameraImage cameraImage(const mrpt::obs::CObservationImage& observation,
                        const std::string& folder) {
  CameraImage image;
  const auto& camera = observation.cameraParams;
  image.camera.width = static_cast<int>(camera.ncols);
  image.camera.height = static_cast<int>(camera.nrows);
  image.camera.fx = camera.fx();
  image.camera.fy = camera.fy();
  image.camera.cx = camera.cx();
  image.camera.cy = camera.cy();
  if (observation.image.isExternallyStored()) {
    const std::filesystem::path file(observation.image.getExternalStorageFile());
    image.source =
        file.is_absolute() ? file.string() : (std::filesystem::path(folder) / file).string();
    image.load = [path = image.source] { return loadFile(path); };
  } else {
    image.source = "in the log";
    // Copies share the pixels.
    image.load = [copy = observation.image] { return pixelsOf(copy); };
  }
  return image;
}

}  // namespace perception
