#pragma once
#include <map>
#include <memory>
#include <mutex>

#include "libperception/detectors/Detector.h"
#include "libperception/detectors/panorama/Panorama.h"

namespace perception {

/// A detector for any camera: pinhole images directly, full panoramas by their eight tiles.
class ImageDetector {
 public:
  explicit ImageDetector(DetectorSetup setup);

  /// Boxes in pixels of the image, one per object. `T_ego_camera` (optical frame), when known,
  /// restricts the search by the ground. `camera.projection` selects pinhole or panorama. Scores
  /// are in the back end's own unit.
  ObjectDetections detect(const Raster& image, const CameraModel& camera,
                          const std::optional<Pose3>& T_ego_camera,
                          const GroundPlane& ground = {}) const;
  const DetectorSetup& setup() const { return setup_; }
  bool hasBackend() const { return detector_ != nullptr; }

 private:
  std::optional<GroundGate> gateOf(const CameraModel& camera,
                                   const std::optional<Pose3>& T_ego_camera,
                                   const GroundPlane& ground) const;
  const Panorama& panorama(int width) const;

  DetectorSetup setup_;
  std::unique_ptr<Detector> detector_;
  mutable std::mutex mutex_;
  mutable std::map<int, Panorama> panoramas_;  ///< by width
};

}  // namespace perception
