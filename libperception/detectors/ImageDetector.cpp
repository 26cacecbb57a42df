#include "libperception/detectors/ImageDetector.h"

#include <tbb/parallel_for.h>

#include <cmath>

#include "libperception/detectors/panorama/PanoramaFit.h"

namespace perception {
namespace {

/// T_ego_camera of a camera rotated to the right by `angle` [rad] about its vertical axis.
Pose3 turnedRight(const Pose3& T_ego_camera, double angle) {
  Pose3 turn = Pose3::Identity();
  turn.linear() << std::cos(angle), 0, std::sin(angle), 0, 1, 0, -std::sin(angle), 0,
      std::cos(angle);
  return T_ego_camera * turn;
}

}  // namespace

ImageDetector::ImageDetector(DetectorSetup setup)
    : setup_(std::move(setup)), detector_(makeDetector(setup_)) {}

std::optional<GroundGate> ImageDetector::gateOf(const CameraModel& camera,
                                                const std::optional<Pose3>& T_ego_camera,
                                                const GroundPlane& ground) const {
  if (!setup_.ground_gate || !T_ego_camera) return std::nullopt;
  return groundGate(camera, *T_ego_camera, ground, setup_.ground_slope_sigma);
}

const Panorama& ImageDetector::panorama(int width) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return panoramas_.try_emplace(width, width).first->second;
}

ObjectDetections ImageDetector::detect(const Raster& image, const CameraModel& camera,
                                       const std::optional<Pose3>& T_ego_camera,
                                       const GroundPlane& ground) const {
  ObjectDetections out;
  out.camera = camera;
  out.camera.width = image.width;
  out.camera.height = image.height;
  out.T_ego_camera = T_ego_camera;
  if (!detector_ || image.width <= 0 || image.height <= 0) return out;
  if (camera.projection != CameraModel::Projection::kEquirectangular) {
    out.objects = detector_->detect(image, {gateOf(camera, T_ego_camera, ground), false});
    return out;
  }
  const PanoramaFit fit(out.camera);
  const Panorama& whole = panorama(fit.width());
  const Raster fitted = fit.isWhole() ? Raster{} : fit.whole(image);
  const Raster& sphere = fit.isWhole() ? image : fitted;
  std::vector<std::vector<ObjectDetection>> tiles(Panorama::kTiles);
  const auto look = [&](int k) {
    std::optional<Pose3> pose;
    if (T_ego_camera) pose = turnedRight(*T_ego_camera, Panorama::tileAzimuth(k));
    tiles[static_cast<std::size_t>(k)] =
        detector_->detect(whole.tile(sphere, k), {gateOf(whole.tileCamera(), pose, ground), true});
  };
  if (detector_->parallel()) {
    tbb::parallel_for(0, Panorama::kTiles, look);
  } else {
    for (int k = 0; k < Panorama::kTiles; ++k) look(k);
  }
  out.objects = whole.merge(tiles).objects;
  if (!fit.isWhole()) fit.toPicture(out.objects);
  return out;
}

}  // namespace perception
