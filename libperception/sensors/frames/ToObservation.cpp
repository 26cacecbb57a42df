#include "libperception/sensors/frames/ToObservation.h"

#include <fmt/format.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationRobotPose.h>

#include <opencv2/core.hpp>

#include "libperception/sensors/observations/CObservationLidarScan.h"
#include "libperception/sensors/observations/CObservationObjectDetections.h"
#include "libperception/sensors/observations/CObservationRadarScan.h"
#include "libperception/sensors/observations/Conversions.h"

namespace perception {
namespace {

/// [%] of simulated images: hardly any loss can be seen, and a third of the bytes of 95.
constexpr int kJpegQuality = 80;

// MRPT's default is raw pixels. Once: another thread may be writing the image before.
void compressImages() {
  static const bool done = [] {
    mrpt::img::CImage::DISABLE_JPEG_COMPRESSION(false);
    mrpt::img::CImage::SERIALIZATION_JPEG_QUALITY(kJpegQuality);
    return true;
  }();
  static_cast<void>(done);
}

std::shared_ptr<mrpt::obs::CObservation> imageObservation(const CameraImage& image) {
  auto result = std::make_shared<mrpt::obs::CObservationImage>();
  const CameraModel& camera = image.camera;
  result->cameraParams.ncols = static_cast<std::uint32_t>(camera.width);
  result->cameraParams.nrows = static_cast<std::uint32_t>(camera.height);
  const bool pinhole = camera.projection == CameraModel::Projection::kPinhole;
  if (pinhole) {
    result->cameraParams.setIntrinsicParamsFromValues(camera.fx, camera.fy, camera.cx, camera.cy);
  } else {
    result->cameraParams.intrinsicParams.setZero();
  }
  const auto raster = image.load ? image.load() : std::nullopt;
  if (!raster) return result;
  compressImages();
  const cv::Mat pixels(raster->height, raster->width, CV_8UC(raster->channels),
                       const_cast<std::uint8_t*>(raster->pixels.data()));
  result->image = mrpt::img::CImage(pixels, mrpt::img::DEEP_COPY);
  return result;
}

}  // namespace

std::shared_ptr<mrpt::obs::CObservation> observationFromFrame(const SensorFrame& frame) {
  std::shared_ptr<mrpt::obs::CObservation> result;
  if (const auto* cloud = std::get_if<LidarCloud>(&frame.data)) {
    auto scan = std::make_shared<CObservationLidarScan>();
    scan->cloud = *cloud;
    result = scan;
  } else if (const auto* returns = std::get_if<RadarReturns>(&frame.data)) {
    auto radar = std::make_shared<CObservationRadarScan>();
    radar->scan = *returns;
    result = radar;
  } else if (const auto* image = std::get_if<CameraImage>(&frame.data)) {
    result = imageObservation(*image);
  } else {
    auto detections = std::make_shared<CObservationObjectDetections>();
    detections->detections = std::get<ObjectDetections>(frame.data);
    result = detections;
  }
  result->timestamp = fromStamp(frame.stamp);
  result->sensorLabel = frame.sensor;
  result->setSensorPose(toMrpt(frame.T_ego_sensor));
  return result;
}

std::shared_ptr<mrpt::obs::CObservation> poseObservation(const EgoState& ego,
                                                         const std::string& label) {
  auto result = std::make_shared<mrpt::obs::CObservationRobotPose>();
  result->timestamp = fromStamp(ego.stamp);
  result->sensorLabel = label;
  result->pose.mean = toMrpt(ego.T_world_ego);
  result->pose.cov.setZero();  // order of MRPT: x y z yaw pitch roll
  const auto& u = ego.uncertainty;
  result->pose.cov(0, 0) = result->pose.cov(1, 1) = u.sigma_xy * u.sigma_xy;
  result->pose.cov(3, 3) = u.sigma_yaw * u.sigma_yaw;
  result->pose.cov(4, 4) = u.sigma_pitch * u.sigma_pitch;
  return result;
}

std::shared_ptr<mrpt::obs::CObservation> frameComment(Stamp stamp, std::int64_t number) {
  auto result = std::make_shared<mrpt::obs::CObservationComment>();
  result->timestamp = fromStamp(stamp);
  result->sensorLabel = kFrameLabel;
  result->text = fmt::format("frame {}", number);
  return result;
}

}  // namespace perception
