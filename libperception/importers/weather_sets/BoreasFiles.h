#pragma once
#include <string>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/core/Time.h"
#include "libperception/importers/ImportText.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// [m] of the first cell of the radar's pictures.
inline constexpr double kBoreasRangeOffset = -0.31;

// Readers of a drive's files. They throw DataError: missing (kNoInput), else with the place and
// what was expected.

/// Files are named by their microseconds since 1970.
Stamp stampOfBoreas(const FrameFile& file);

/// Poses of the lidar, east, north, up: applanix/lidar_poses.csv, t [us] x y z vx vy vz r p y ...;
/// rotation Rx(-r) Ry(-p) Rz(-y), as in the data set's kit.
std::vector<StampedPose> readBoreasPoses(const std::string& path);

/// calib/T_A_B.txt: four rows of four numbers.
Pose3 readBoreasTransform(const std::string& path);

/// calib/P_camera.txt: a pinhole; width and height follow from the images.
CameraModel readBoreasCamera(const std::string& path);

/// A turn of the radar: a row a beam.
struct BoreasRadar {
  Raster power;
  std::vector<double> azimuths;  ///< [rad] of each row
};
/// radar/US.png: each row begins with its time (8 bytes), encoder (2) and an unused one.
BoreasRadar readBoreasRadar(const std::string& path);

}  // namespace perception
