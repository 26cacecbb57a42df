#include "libperception/app/SnapshotImage.h"

#include <mrpt/obs/CObservationImage.h>

#include <filesystem>
#include <memory>
#include <opencv2/imgcodecs.hpp>

#include "libperception/sensors/Conversions.h"

namespace perception {
namespace {

Raster rasterOf(const cv::Mat& pixels) {
  Raster raster{pixels.cols, pixels.rows, pixels.channels(), {}};
  for (int y = 0; y < pixels.rows; ++y) {
    const auto* row = pixels.ptr<std::uint8_t>(y);
    raster.pixels.insert(raster.pixels.end(), row, row + pixels.cols * pixels.channels());
  }
  return raster;
}

std::optional<Raster> loadFile(const std::string& path) {
  if (!std::filesystem::exists(path)) return std::nullopt;
  const cv::Mat pixels = cv::imread(path, cv::IMREAD_COLOR);
  if (pixels.empty()) return std::nullopt;
  return rasterOf(pixels);
}

std::string externalPath(const std::string& name, const std::string& log) {
  const std::filesystem::path file(name);
  if (file.is_absolute()) return name;
  const std::filesystem::path path(log);
  return (path.parent_path() / (path.stem().string() + "_Images") / file).string();
}

}  // namespace

std::optional<SensorFrame> imageFrame(const mrpt::obs::CObservation& observation,
                                      const std::string& log) {
  const auto* image = dynamic_cast<const mrpt::obs::CObservationImage*>(&observation);
  const auto stamp = image ? toStamp(image->timestamp) : std::nullopt;
  if (!stamp) return std::nullopt;
  CameraImage data;
  const auto& camera = image->cameraParams;
  data.camera.width = static_cast<int>(camera.ncols);
  data.camera.height = static_cast<int>(camera.nrows);
  data.camera.fx = camera.fx();
  data.camera.fy = camera.fy();
  data.camera.cx = camera.cx();
  data.camera.cy = camera.cy();
  if (image->image.isExternallyStored()) {
    data.source = externalPath(image->image.getExternalStorageFile(), log);
    data.load = [path = data.source] { return loadFile(path); };
  } else {
    data.source = "in the log";
    // Copies share the pixels.
    data.load = [copy = image->image]() -> std::optional<Raster> {
      if (copy.isEmpty()) return std::nullopt;
      return rasterOf(copy.asCvMat<cv::Mat>(mrpt::img::SHALLOW_COPY));
    };
  }
  SensorFrame frame;
  frame.sensor = image->sensorLabel;
  frame.stamp = *stamp;
  frame.T_ego_sensor = toPose3(image->cameraPose);
  frame.data = std::move(data);
  return frame;
}

}  // namespace perception
