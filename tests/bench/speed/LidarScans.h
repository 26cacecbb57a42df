#pragma once
#include <dirent.h>
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <ctime>
#include <string>
#include <vector>

#include "libperception/importers/clouds/ImportClouds.h"
#include "libperception/lidar/LidarFrontEnd.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception::bench {

/// A recorded scan, with the class of every point where the recording has them.
struct RecordedScan {
  std::string set;  ///< for the report
  std::int64_t number = 0;
  SensorFrame frame;                       ///< sensor straight above the ego origin on the road
  std::vector<std::uint16_t> point_class;  ///< WADS numbers; empty: none
};

/// The lidar front end alone, without what a tracker has to know of it.
inline LidarFrontEnd frontEnd(const LidarParams& params) {
  ClassTable classes;
  classes.classes.resize(1);
  return LidarFrontEnd(params, classes,
                       DetectionModel(DetectionParams{}, {ClassDetection{}},
                                      LidarFrontEnd::labels(params.clusters)));
}

inline double cpuSeconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

inline double quantile(std::vector<double> v, double q) {
  if (v.empty()) return 0;
  std::sort(v.begin(), v.end());
  return v[static_cast<std::size_t>(q * static_cast<double>(v.size() - 1) + 0.5)];
}

/// Files of a folder with that ending, sorted; none where there is no such folder.
inline std::vector<std::string> filesOf(const std::string& folder, const std::string& ending) {
  std::vector<std::string> names;
  if (DIR* dir = opendir(folder.c_str())) {
    while (const dirent* entry = readdir(dir)) {
      const std::string name = entry->d_name;
      if (name.size() > ending.size() &&
          name.compare(name.size() - ending.size(), ending.size(), ending) == 0)
        names.push_back(name);
    }
    closedir(dir);
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// The lower half of each label: the class of a point.
inline std::vector<std::uint16_t> readPointClasses(const std::string& path) {
  std::vector<std::uint16_t> classes;
  gzFile file = gzopen(path.c_str(), "rb");
  if (file == nullptr) return classes;
  for (std::uint32_t label = 0; gzread(file, &label, 4) == 4;)
    classes.push_back(static_cast<std::uint16_t>(label & 0xFFFF));
  gzclose(file);
  return classes;
}

/// All scans of DIR/velodyne-like folder; height [m] of the sensor above the road.
inline std::vector<RecordedScan> readScans(const std::string& set, const std::string& folder,
                                           double height, double intensity_max,
                                           const std::string& labels = "") {
  std::vector<RecordedScan> scans;
  CloudFormat format;
  format.intensity_max = intensity_max;
  for (const std::string& name : filesOf(folder, ".bin.gz")) {
    RecordedScan scan;
    scan.set = set;
    scan.number = std::stoll(name.substr(0, name.find('.')));
    scan.frame.sensor = "LIDAR_TOP";
    scan.frame.frame = scan.number;
    scan.frame.stamp = Stamp::fromSeconds(1e9 + 0.1 * static_cast<double>(scan.number));
    scan.frame.T_ego_sensor = makePose(0, 0, height, 0);
    scan.frame.data = readCloudFile(folder + "/" + name, format);
    if (!labels.empty())
      scan.point_class =
          readPointClasses(labels + "/" + name.substr(0, name.find('.')) + ".label.gz");
    scans.push_back(std::move(scan));
  }
  return scans;
}

inline std::string recording(const std::string& path) {
  return std::string(PERCEPTION_SHARED_DATA) + "/data/" + path;
}
inline std::vector<RecordedScan> kittiFull() {
  return readScans("KITTI 0000, 360 deg", recording("kitti_lidar_seq0000/velodyne_full"), 1.73, 0);
}
inline std::vector<RecordedScan> kittiFront() {
  return readScans("KITTI 0000, 120 deg", recording("kitti_lidar_seq0000/velodyne_front120"), 1.73,
                   0);
}
inline std::vector<RecordedScan> wads() {
  return readScans("WADS 36, snow", recording("wads_snow/velodyne"), 2.17, 255,
                   recording("wads_snow/labels"));
}

}  // namespace perception::bench
