#include "studies/resolution/ResolutionImages.h"

#include <fmt/format.h>

#include <chrono>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "libperception/config/Config.h"
#include "libperception/core/Error.h"
#include "libperception/detectors/CvRaster.h"
#include "libperception/measurement/models/CameraResolution.h"
#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/sensors/frames/ToObservation.h"
#include "libperception/sensors/images/CameraImages.h"

namespace perception {
namespace {

constexpr double kEnlarge = 1.05;  // largest upscaling: images are not used beyond their resolution

}  // namespace

ResolutionImages::ResolutionImages(const std::string& log, const std::string& label,
                                   const std::string& detector)
    : log_(log), label_(label), folder_(imagesBeside(log)) {
  Config config = Config::fromFile(detector);
  detector_ = std::make_unique<ImageDetector>(DetectorSetup::read(config));
  if (!detector_->hasBackend())
    throw ConfigError(detector + ": [detector] backend = file finds no boxes");
}

bool ResolutionImages::isOurs(const mrpt::obs::CObservation& observation) const {
  return isImage(observation) && (label_.empty() || observation.sensorLabel == label_);
}

std::optional<Raster> ResolutionImages::load(const mrpt::obs::CObservation& observation) {
  auto frame = frameFromObservation(observation, nullptr, folder_);
  if (!frame) return std::nullopt;
  const auto& image = std::get<CameraImage>(frame->data);
  auto pixels = image.load ? image.load() : std::nullopt;
  if (!pixels || pixels->width <= 0) {
    ++missing_;
    return std::nullopt;
  }
  camera_ = image.camera;
  if (camera_.fx <= 0) {
    if (pixels->width != 2 * pixels->height)
      throw DataError(fmt::format(
          "{}: images of {} x {} without calibration: neither a panorama (twice as wide as high) "
          "nor a camera whose angles are known",
          log_, pixels->width, pixels->height));
    camera_.projection = CameraModel::Projection::kEquirectangular;
    camera_.fx = pixels->width / kTwoPi;
  }
  frame_ = std::move(frame);
  return pixels;
}

double ResolutionImages::scaleTo(int resolution) const {
  return cameraResolutions()[static_cast<std::size_t>(resolution)].width / (kTwoPi * camera_.fx);
}

std::vector<int> ResolutionImages::resolutions() const {
  std::vector<int> out;
  for (int r = 0; r < static_cast<int>(cameraResolutions().size()); ++r) {
    if (scaleTo(r) <= kEnlarge) out.push_back(r);
  }
  return out;
}

std::shared_ptr<mrpt::obs::CObservation> ResolutionImages::boxes(const Raster& image,
                                                                 int resolution,
                                                                 const std::string& label) {
  const auto start = std::chrono::steady_clock::now();
  const double scale = scaleTo(resolution);
  CameraModel camera = camera_;
  cv::Size size(cvRound(image.width * scale), cvRound(image.height * scale));
  if (camera.projection == CameraModel::Projection::kEquirectangular) {
    const CameraResolution& row = cameraResolutions()[static_cast<std::size_t>(resolution)];
    size = {row.width, row.height};
    camera = Panorama(row.width).camera();
  } else {
    camera.fx *= scale, camera.fy *= scale;
    camera.cx = (camera.cx + .5) * scale - .5, camera.cy = (camera.cy + .5) * scale - .5;
  }
  Raster small{size.width, size.height, 3, {}};
  small.pixels.resize(static_cast<std::size_t>(size.area()) * 3);
  cv::Mat target(size, CV_8UC3, small.pixels.data());
  cv::resize(colorMat(image), target, size, 0, 0, cv::INTER_AREA);
  ObjectDetections found = detector_->detect(small, camera, frame_->T_ego_sensor);
  calibrateScores(detector_->setup(), found.objects);
  found.T_ego_camera.reset();  // the sensor's frame is the camera's
  SensorFrame frame = *frame_;
  frame.sensor = label;
  frame.data = std::move(found);
  seconds_[resolution] +=
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return observationFromFrame(frame);
}

}  // namespace perception
