#pragma once
#include <optional>
#include <string>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// [camera]: for images without calibration.
struct DetectCameraParams {
  double height = 0;                   ///< [m] above the ground; 0: unknown
  double pitch = 0;                    ///< [rad] nose down
  double field_of_view = radians(80);  ///< [rad] horizontal; assumed, as KITTI's cameras
  double horizon =
      0;  ///< [px] image row of the horizon at pitch 0, also for panoramas; 0: the middle row
  int panorama = 0;  ///< 0 auto (if width = 2 height and no calibration), 1 yes, 2 no

  void visit(ParamVisitor& v);
};

/// Whether an input is a rawlog, by its extension.
bool isRawlog(const std::string& path);
/// Expands folders to the images in them, sorted; files are unchanged.
std::vector<std::string> imageFiles(const std::vector<std::string>& inputs);
/// Empty if missing or not an image.
std::optional<Raster> readImage(const std::string& path);

/// T_ego_camera of a camera at `height` [m] facing forward, pitched down by `pitch` [rad]; optical
/// frame.
Pose3 cameraPose(double height, double pitch);
/// A calibrated camera is a pinhole unless `choice` is yes.
bool isPanorama(const Raster& image, int choice, bool calibrated);
/// The camera model of an image without calibration. Throws DataError naming `name` if `panorama =
/// yes` and the image does not cover the full circle.
CameraModel cameraOf(const Raster& image, const DetectCameraParams& params,
                     const std::string& name);
/// Equirectangular model of the full circle with equal vertical resolution [px/rad].
CameraModel panoramaCamera(const Raster& image, const DetectCameraParams& params,
                           const std::string& name);

}  // namespace perception
