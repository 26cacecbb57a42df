#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// A labeled object of a KITTI tracking sequence (truth by hand; real recordings).
struct KittiTruth {
  std::string type;
  int occluded = 0;
  double truncated = 0;
  ObjectDetection::ImageBox image_box;
  Vector3 bottom = Vector3::Zero();                   ///< [m] ego frame
  double yaw = 0, length = 0, width = 0, height = 0;  ///< [rad, m] ego frame
};

/// One sequence: truth and the image boxes of a detector (RRC), by frame. The ego frame is level
/// under the lidar, as in an imported log.
struct KittiDrive {
  Pose3 T_ego_camera = Pose3::Identity();  ///< camera 2, optical
  CameraModel camera;
  std::map<int, std::vector<KittiTruth>> truth;
  std::map<int, std::vector<ObjectDetection>> boxes;
};

inline std::map<std::string, std::vector<double>> readKittiMatrices(const std::string& path) {
  std::map<std::string, std::vector<double>> matrices;
  std::ifstream file(path);
  for (std::string line, key; std::getline(file, line);) {
    std::istringstream words(line);
    words >> key;
    if (!key.empty() && key.back() == ':') key.pop_back();
    for (double value; words >> value;) matrices[key].push_back(value);
  }
  return matrices;
}

/// Fills pose and camera; returns T_ego_camera0 (rectified), the frame of the labels.
inline Pose3 readKittiCamera(const std::string& path, KittiDrive& drive) {
  const auto matrices = readKittiMatrices(path);
  const auto& R = matrices.at("R0_rect");
  const auto& T = matrices.at("Tr_velo_to_cam");
  const auto& P = matrices.at("P2");
  Pose3 T_camera0_lidar = Pose3::Identity(), rectify = Pose3::Identity();
  for (int i = 0; i < 9; ++i) rectify.linear()(i / 3, i % 3) = R[static_cast<std::size_t>(i)];
  for (int i = 0; i < 12; ++i)
    T_camera0_lidar.matrix()(i / 4, i % 4) = T[static_cast<std::size_t>(i)];
  const Pose3 T_ego_camera0 = makePose(0, 0, 1.73, 0) *
                              (rectify * T_camera0_lidar).inverse();  // ego 1.73 m under the lidar
  // Rectified images are 1242 x 375 px on the first day of recording, 1224 x 370 px on the second.
  const bool first_day = P[0] > 715;
  drive.camera = {first_day ? 1242 : 1224, first_day ? 375 : 370, P[0], P[5], P[2], P[6]};
  // P2 = K [I | t]: camera 2 stands at -t in camera 0.
  const double tz = P[11];
  const Vector3 t((P[3] - P[2] * tz) / P[0], (P[7] - P[6] * tz) / P[5], tz);
  drive.T_ego_camera = T_ego_camera0 * Eigen::Translation3d(-t);
  return T_ego_camera0;
}

inline void readKittiLabels(const std::string& path, const Pose3& T_ego_camera0,
                            KittiDrive& drive) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    int frame = 0, id = 0;
    double alpha = 0, x = 0, y = 0, z = 0, rotation = 0;
    KittiTruth o;
    auto& b = o.image_box;
    words >> frame >> id >> o.type >> o.truncated >> o.occluded >> alpha >> b.x1 >> b.y1 >> b.x2 >>
        b.y2 >> o.height >> o.width >> o.length >> x >> y >> z >> rotation;
    if (!words || o.type == "DontCare") continue;
    o.bottom = T_ego_camera0 * Vector3(x, y, z);
    const Vector3 along =
        T_ego_camera0.linear() * Vector3(std::cos(rotation), 0, -std::sin(rotation));
    o.yaw = std::atan2(along.y(), along.x());
    drive.truth[frame].push_back(o);
  }
}

/// Rows frame,x1,y1,x2,y2,score.
inline void readKittiBoxes(const std::string& path, const std::string& label, KittiDrive& drive) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    int frame = 0;
    ObjectDetection o;
    ObjectDetection::ImageBox b;
    words >> frame >> b.x1 >> b.y1 >> b.x2 >> b.y2 >> o.score;
    if (!words) continue;
    o.label = label;
    o.image_box = b;
    drive.boxes[frame].push_back(o);
  }
}

/// Image boxes with observation angles, in KITTI's tracking layout.
inline std::map<int, std::vector<ObjectDetection>> readKittiOrientedBoxes(const std::string& path) {
  std::map<int, std::vector<ObjectDetection>> boxes;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    int frame = 0, id = 0;
    double skip = 0, alpha = 0;
    ObjectDetection o;
    ObjectDetection::ImageBox b;
    words >> frame >> id >> o.label >> skip >> skip >> alpha >> b.x1 >> b.y1 >> b.x2 >> b.y2;
    for (int i = 0; i < 7; ++i) words >> skip;
    words >> o.score;
    if (!words) continue;
    o.image_box = b;
    o.heading = alpha;
    boxes[frame].push_back(o);
  }
  return boxes;
}

/// `folder` is .../kitti_tracking/. Empty truth when the recordings are not there.
inline KittiDrive readKittiDrive(const std::string& folder, const std::string& sequence) {
  KittiDrive drive;
  const std::string calibration = folder + "calib/" + sequence + ".txt";
  if (!std::ifstream(calibration)) return drive;
  const Pose3 T_ego_camera0 = readKittiCamera(calibration, drive);
  readKittiLabels(folder + "label_02/" + sequence + ".txt", T_ego_camera0, drive);
  for (const char* type : {"Car", "Pedestrian"})
    readKittiBoxes(folder + "det_rrc/" + type + "/" + sequence + ".txt", type, drive);
  return drive;
}

/// Intersection over union of two image boxes.
inline double overlap(const ObjectDetection::ImageBox& a, const ObjectDetection::ImageBox& b) {
  const double w = std::min(a.x2, b.x2) - std::max(a.x1, b.x1);
  const double h = std::min(a.y2, b.y2) - std::max(a.y1, b.y1);
  if (w <= 0 || h <= 0) return 0;
  const double both = w * h;
  return both / ((a.x2 - a.x1) * (a.y2 - a.y1) + (b.x2 - b.x1) * (b.y2 - b.y1) - both);
}

}  // namespace perception
