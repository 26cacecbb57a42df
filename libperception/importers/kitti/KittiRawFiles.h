#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "libperception/importers/ImportText.h"
#include "libperception/importers/kitti/KittiFiles.h"

namespace perception {

/// Calibration of KITTI's raw drives: calib_velo_to_cam.txt, calib_cam_to_cam.txt and
/// calib_imu_to_velo.txt of a day's folder. Throws DataError as the readers of KittiFiles.h.
KittiCalibration readKittiRawCalibration(const std::string& folder);

/// The stamps of a timestamps.txt: line k is file k of the data/ beside it.
std::vector<Stamp> readKittiRawStamps(const std::string& path);

/// A box of a tracklet in one frame, in the Velodyne frame.
struct KittiTracklet {
  std::int64_t id = -1;  ///< number of the tracklet in the file
  std::string type;
  ObjectDetection::SpaceBox box;
  int occluded = 0;      ///< KITTI: 0 visible, 1 partly, 2 largely occluded, 3 unknown
  bool cut = false;      ///< by the image's edge
  bool outside = false;  ///< of the image
};

/// Boxes of a tracklet_labels.xml (a boost serialization), by frame. Throws DataError.
std::multimap<std::int64_t, KittiTracklet> readKittiTracklets(const std::string& path);

/// The files of a sensor, each with its stamp.
struct KittiRawSeries {
  std::vector<FrameFile> files;
  std::vector<Stamp> stamps;
};
/// FOLDER/data and FOLDER/timestamps.txt: file k has the stamp of line k, also where files before
/// are missing. CADC has the same.
KittiRawSeries readKittiRawSeries(const std::string& folder,
                                  const std::vector<std::string>& endings);

}  // namespace perception
