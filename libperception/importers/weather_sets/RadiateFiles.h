#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "libperception/importers/ImportLog.h"
#include "libperception/importers/ImportText.h"
#include "libperception/importers/positions/ImportGps.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Stamps by frame.
using FrameTimes = std::map<std::int64_t, Stamp>;

/// A sequence's times: "Frame: 000018 Time: 1574859771.700975000". Throws DataError.
FrameTimes readRadiateTimes(const std::filesystem::path& path);

/// A file of a frame with its time.
struct TimedFile {
  FrameFile file;
  Stamp stamp;
};

/// The files of a folder that have a time; others are skipped with a warning. `wanted`: only frames
/// within --first and --last.
std::vector<TimedFile> timedFiles(const std::filesystem::path& folder,
                                  const std::vector<std::string>& endings, const FrameTimes& times,
                                  bool wanted, ImportLog& log);

/// A scan of the lidar. Throws DataError.
LidarCloud readRadiateScan(const std::string& path);

/// GPS fixes by steadyFixes(), `dropped` increased by those skipped. Throws DataError.
std::vector<GpsFix> readRadiateFixes(const std::filesystem::path& dir, std::size_t& dropped);

/// Path of the annotations of a sequence; empty: none.
std::string radiateAnnotationFile(const std::filesystem::path& dir);

/// A box of the annotations, in pixels of Navtech_Cartesian.
struct RadiateAnnotation {
  std::int64_t id = 0;
  std::string type;
  double x = 0, y = 0, width = 0, length = 0;  ///< [px] top left corner and size before rotation
  double rotation = 0;                         ///< [deg] counter-clockwise about the center
};

/// The annotations by frame, from 1 on. Throws DataError.
std::map<std::int64_t, std::vector<RadiateAnnotation>> readRadiateAnnotations(
    const std::string& path);

/// calib.yaml: translations from the radar, x right, y ahead, z up.
struct RadiateCalibration {
  Vector3 lidar = Vector3::Zero(), camera = Vector3::Zero();  ///< [m] right, ahead, up of the radar
  CameraModel model;
  std::vector<double> distortion;  ///< k1 k2 p1 p2 k3
};

/// Throws DataError: missing (kNoInput), or incomplete.
RadiateCalibration readRadiateCalibration(const std::string& path);

}  // namespace perception
