#pragma once
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception::test {

/// A lidar scan whose every return has a class.
struct LabeledScan {
  int number = 0;  ///< of the file
  SensorFrame frame;
  std::vector<std::uint32_t> labels;  ///< as in the data set
};

// Classes of WADS.
constexpr std::uint32_t kUnlabeled = 0, kCarLabel = 10, kOtherVehicleLabel = 20, kPersonLabel = 30,
                        kSnowLabel = 110;
inline bool isRoadUser(std::uint32_t label) {
  return label == kCarLabel || label == kOtherVehicleLabel || label == kPersonLabel;
}

inline std::string gunzip(const std::string& path) {
  std::string bytes;
  gzFile file = gzopen(path.c_str(), "rb");
  if (file == nullptr) return bytes;
  char buffer[1 << 16];
  for (int n = gzread(file, buffer, sizeof buffer); n > 0; n = gzread(file, buffer, sizeof buffer))
    bytes.append(buffer, static_cast<std::size_t>(n));
  gzclose(file);
  return bytes;
}

template <class Number>
std::vector<Number> numbersOf(const std::string& bytes) {
  std::vector<Number> numbers(bytes.size() / sizeof(Number));
  if (!numbers.empty()) std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(Number));
  return numbers;
}

/// DIR/velodyne/N.bin.gz with DIR/labels/N.label.gz and DIR/poses.txt, where there are such, as
/// frames of a lidar at `height` [m] above the ground, 10 Hz. Empty when DIR is not there.
inline std::vector<LabeledScan> labeledScans(const std::string& dir, double height,
                                             std::size_t most = 1000,
                                             const std::string& folder = "velodyne") {
  namespace fs = std::filesystem;
  std::vector<LabeledScan> scans;
  if (!fs::is_directory(dir + "/" + folder)) return scans;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(dir + "/" + folder))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<Pose3> poses;
  std::ifstream lines(dir + "/poses.txt");
  for (std::string line; std::getline(lines, line);) {
    std::istringstream numbers(line);
    Pose3 pose = Pose3::Identity();
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column) numbers >> pose.matrix()(row, column);
    poses.push_back(pose);
  }
  const Pose3 T_ego_lidar = makePose(0, 0, height, 0);
  for (std::size_t i = 0; i < files.size() && i < most; ++i) {
    LabeledScan& scan = scans.emplace_back();
    const std::string stem = files[i].filename().string().substr(0, 6);
    scan.number = std::atoi(stem.c_str());
    scan.frame.sensor = "LIDAR_TOP";
    scan.frame.stamp = Stamp::fromSeconds(1000 + 0.1 * static_cast<double>(i));
    scan.frame.T_ego_sensor = T_ego_lidar;
    scan.frame.ego.stamp = scan.frame.stamp;
    if (i < poses.size())
      scan.frame.ego.T_world_ego =
          T_ego_lidar * poses.front().inverse() * poses[i] * T_ego_lidar.inverse();
    const auto values = numbersOf<float>(gunzip(files[i].string()));
    LidarCloud cloud;
    for (std::size_t k = 0; k + 3 < values.size(); k += 4) {
      cloud.x.push_back(values[k]), cloud.y.push_back(values[k + 1]);
      cloud.z.push_back(values[k + 2]);
      cloud.intensity.push_back(values[k + 3]);
    }
    const auto brightest = std::max_element(cloud.intensity.begin(), cloud.intensity.end());
    const float scale = brightest != cloud.intensity.end() && *brightest > 1 ? 1.F / 255 : 1.F;
    for (float& value : cloud.intensity) value *= scale;
    scan.frame.data = std::move(cloud);
    scan.labels = numbersOf<std::uint32_t>(gunzip(dir + "/labels/" + stem + ".label.gz"));
    for (std::uint32_t& label : scan.labels) label &= 0xFFFF;  // the upper half is an instance
  }
  return scans;
}

/// How well phantoms were told from surfaces.
struct PhantomScore {
  std::size_t hits = 0, false_alarms = 0, misses = 0;  ///< [returns]
  std::size_t road_users = 0, road_users_lost = 0;     ///< [returns] of cars and persons

  double f1() const {
    return 2.0 * static_cast<double>(hits) /
           std::max(1.0, static_cast<double>(2 * hits + false_alarms + misses));
  }
  double precision() const {
    return static_cast<double>(hits) / std::max(1.0, static_cast<double>(hits + false_alarms));
  }
  double recall() const {
    return static_cast<double>(hits) / std::max(1.0, static_cast<double>(hits + misses));
  }
  double lost() const {
    return static_cast<double>(road_users_lost) / std::max(1.0, static_cast<double>(road_users));
  }
  void add(const LabeledScan& scan, const std::vector<float>& trust, std::uint32_t phantom,
           bool unlabeled_too = false) {
    for (std::size_t i = 0; i < trust.size(); ++i) {
      const std::uint32_t label = scan.labels[i];
      const bool found = trust[i] < 0.5F;
      if (phantom == kSnowLabel) {
        road_users += isRoadUser(label), road_users_lost += isRoadUser(label) && found;
        if (label == kUnlabeled && !unlabeled_too) continue;
      }
      hits += found && label == phantom, misses += !found && label == phantom;
      false_alarms += found && label != phantom;
    }
  }
};

}  // namespace perception::test
