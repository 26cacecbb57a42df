#pragma once
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libperception/core/Frames.h"

namespace perception {

/// [px] a region of the camera's image: left, top, right, bottom edge.
struct ImageArea {
  double left = 0, top = 0, right = 0, bottom = 0;
};

/// One object of the truth at one instant: a line of FILE.truth.csv. World frame, SI units; NaN
/// where unknown.
struct TruthObject {
  std::int64_t frame = -1;  ///< the log's frame number
  double t = 0;             ///< [s] since the log's first stamp
  std::int64_t id = -1;
  std::string
      type;  ///< class as in KITTI: Pedestrian, Cyclist, Car, Van, Truck, Misc, DontCare ...
  Vector3 position = Vector3::Zero();        ///< [m] center of the footprint, z = bottom
  double yaw = 0;                            ///< [rad]
  double length = 0, width = 0, height = 0;  ///< [m]
  double vx = std::numeric_limits<double>::quiet_NaN(), vy = vx;  ///< [m/s]
  double truncated = 0;           ///< [0, 1] share outside the image
  int occluded = 0;               ///< KITTI: 0 visible, 1 partly, 2 largely occluded, 3 unknown
  int lidar_points = -1;          ///< returns inside the box; -1: the log has no lidar
  bool ignore = false;            ///< DontCare and types that no class covers
  std::optional<ImageArea> area;  ///< where an area without labels (DontCare) lies, if known
};

/// The truth of a log by instant.
struct GroundTruth {
  struct Instant {
    std::int64_t frame = -1;
    double t = 0;
    std::vector<TruthObject> objects;
  };
  std::vector<Instant> instants;  ///< in order of time
};

/// Reads FILE.truth.csv. Throws DataError with file, line and column.
GroundTruth readGroundTruth(const std::string& path);
/// FILE.truth.csv beside FILE.rawlog, where the truth of a log stands.
std::string truthFileOf(const std::string& rawlog);
/// FILE_Labels beside FILE.rawlog, with the class of each point in a file NUMBER.label for each
/// frame.
std::string labelFolderOf(const std::string& rawlog);
/// Reads the truth beside a log. Throws as readGroundTruth().
GroundTruth truthBeside(const std::string& rawlog);
/// Writes it, in a fixed number format.
void writeGroundTruth(const std::string& path, const std::vector<TruthObject>& rows);

}  // namespace perception
