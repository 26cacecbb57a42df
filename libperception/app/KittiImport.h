#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "libperception/core/GroundTruth.h"

namespace perception {

/// What is imported from a KITTI tracking sequence, and how.
struct KittiImportParams {
  std::string calibration;               ///< calibration file
  std::string poses;                     ///< ego motion, one line a frame ...
  std::string poses_frame = "velodyne";  ///< ... of velodyne, camera or imu
  std::string poses_format = "kitti";    ///< ... kitti or tum
  std::string oxts;                      ///< instead of poses
  std::string lidar_dir, images_dir;     ///< empty: none
  std::string labels;                    ///< truth; empty: none
  struct Detections {
    std::string name;        ///< detector; becomes the sensor label
    std::string class_name;  ///< rows of this type, or all
    std::string file;
  };
  std::vector<Detections> detections;
  double rate = 10;                   ///< [Hz] of the frames (the cars' true rate was 9.66)
  std::int64_t first = 0, last = -1;  ///< frame numbers; last -1: to the end of the poses
  bool embed_images = false;          ///< as JPEG inside the log instead of files beside it
  std::string output;                 ///< FILE.rawlog
};

/// What an import wrote.
struct KittiImportResult {
  std::int64_t frames = 0, scans = 0, images = 0;
  std::uint64_t points = 0;
  std::map<std::string, std::uint64_t> detections;   ///< by detector
  std::uint64_t truth_rows = 0;                      ///< ignored ones included
  std::map<std::string, std::uint64_t> truth_types;  ///< rows by type
  std::string truth_file;                            ///< empty without labels
  std::uint64_t entries = 0, bytes = 0, bytes_inflated = 0;
  std::vector<std::string> warnings;  ///< parts of the data that are missing
};

/// Writes FILE.rawlog and, with labels, FILE.truth.csv; frame by frame, so memory does not grow
/// with the sequence. World: the ego frame at line 0 of the poses, 1.73 m under the Velodyne.
/// `progress(done, total)` is called per frame. Throws Error (kUsage), DataError, OutputError.
KittiImportResult importKitti(const KittiImportParams& params,
                              const std::function<void(std::int64_t, std::int64_t)>& progress = {});

/// FILE.truth.csv beside FILE.rawlog.
std::string truthFileOf(const std::string& rawlog);

}  // namespace perception
