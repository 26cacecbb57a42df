#pragma once
#include <optional>
#include <string>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// [camera]: of images that come without a calibration of their own.
struct DetectCameraParams {
  double height = 0;                   ///< [m] over the ground; 0: not known
  double pitch = 0;                    ///< [rad] nose down
  double field_of_view = radians(80);  ///< [rad] across; assumed, as wide as KITTI's cameras
  double horizon = 0;                  ///< [px] row at pitch 0, of panoramas, too; 0: the middle
  int panorama = 0;  ///< auto (width = 2 height, no calibration), yes, no: a fact of the picture

  void visit(ParamVisitor& v);
};

/// perception-detect's inputs: a rawlog, by its ending.
bool isRawlog(const std::string& path);
/// Files as they are, folders as the images in them, in order.
std::vector<std::string> imageFiles(const std::vector<std::string>& inputs);
/// Empty: not there, or no image.
std::optional<Raster> readImage(const std::string& path);

/// Camera `height` [m] over the ground, looking ahead, `pitch` [rad] nose down; optical frame.
Pose3 cameraPose(double height, double pitch);
/// A calibrated camera is a pinhole unless the INI says otherwise.
bool isPanorama(const Raster& image, int choice, bool calibrated);
/// The camera of an image without calibration. `name` for the message of a DataError: `panorama =
/// yes` and no picture of the full circle.
CameraModel cameraOf(const Raster& image, const DetectCameraParams& params,
                     const std::string& name);
/// The full circle across, with as many pixels a radian downwards.
CameraModel panoramaCamera(const Raster& image, const DetectCameraParams& params,
                           const std::string& name);

}  // namespace perception
