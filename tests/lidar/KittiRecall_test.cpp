#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <map>
#include <memory>
#include <sstream>

#include "libperception/lidar/LidarFrontEnd.h"
#include "libperception/lidar/ground/GroundPlane.h"

namespace perception {
namespace {

/// One labeled object, in the lidar's frame.
struct Labeled {
  int id = -1;
  std::string type;
  Vector3 bottom = Vector3::Zero();                   ///< [m]
  double yaw = 0, length = 0, width = 0, height = 0;  ///< [rad, m]
};

std::string data(const std::string& path) {
  return std::string(PERCEPTION_SHARED_DATA) + "/data/" + path;
}

LidarCloud readScan(const std::string& path) {
  LidarCloud cloud;
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(("gzip -dc '" + path + "'").c_str(), "r"),
                                                   pclose);
  std::array<float, 4> p;
  while (pipe && std::fread(p.data(), sizeof(float), 4, pipe.get()) == 4)
    cloud.x.push_back(p[0]), cloud.y.push_back(p[1]), cloud.z.push_back(p[2]);
  return cloud;
}

Eigen::Matrix4d cameraFromLidar(const std::string& path) {
  Eigen::Matrix4d R = Eigen::Matrix4d::Identity(), T = R;
  std::ifstream file(path);
  for (std::string line, key; std::getline(file, line);) {
    std::istringstream words(line);
    words >> key;
    if (key == "R0_rect:")
      for (int i = 0; i < 9; ++i) words >> R(i / 3, i % 3);
    if (key == "Tr_velo_to_cam:")
      for (int i = 0; i < 12; ++i) words >> T(i / 4, i % 4);
  }
  return R * T;
}

std::map<int, std::vector<Labeled>> readLabels(const std::string& path,
                                               const Eigen::Matrix4d& T_camera_lidar) {
  std::map<int, std::vector<Labeled>> labels;
  const Eigen::Matrix4d inverse = T_camera_lidar.inverse();
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    Labeled object;
    int frame = 0;
    double skip = 0, x = 0, y = 0, z = 0, rotation = 0;
    words >> frame >> object.id >> object.type;
    for (int i = 0; i < 7; ++i) words >> skip;  // truncated, occluded, alpha, image box
    words >> object.height >> object.width >> object.length >> x >> y >> z >> rotation;
    object.bottom = (inverse * Eigen::Vector4d(x, y, z, 1)).head<3>();
    object.yaw = wrapAngle(-rotation - kPi / 2);
    if (object.type != "DontCare") labels[frame].push_back(object);
  }
  return labels;
}

int returnsWithin(const LidarCloud& cloud, const Labeled& object) {
  int count = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vector3 d = Vector3(static_cast<double>(cloud.x[i]), static_cast<double>(cloud.y[i]),
                              static_cast<double>(cloud.z[i])) -
                      object.bottom;
    const Vector2 along = rotate2(-object.yaw, d.head<2>());
    count += std::abs(along.x()) < object.length / 2 && std::abs(along.y()) < object.width / 2 &&
             d.z() > 0.2 && d.z() < object.height;
  }
  return count;
}

/// Every tenth frame of KITTI tracking 0000 (a real recording): all that is within 20 m, ahead and
/// hit by 20 returns.
TEST(KittiRecall, EveryObjectWithin20mIsSeen) {
  const std::string folder = data("kitti_lidar_seq0000/velodyne_full/");
  if (!std::ifstream(folder + "000000.bin.gz")) GTEST_SKIP() << "no recordings in " << folder;
  const auto labels = readLabels(data("kitti_tracking/label_02/0000.txt"),
                                 cameraFromLidar(data("kitti_tracking/calib/0000.txt")));
  LidarParams params;
  params.points.vehicle_front = 2.4,
  params.points.vehicle_rear = 2.6;  // the origin lies below the lidar
  ClassTable classes;
  classes.classes.resize(1);
  const LidarFrontEnd lidar(params, classes,
                            DetectionModel(DetectionParams{}, {ClassDetection{}},
                                           LidarFrontEnd::labels(params.clusters)));
  GroundEstimator ground;

  int active = 0, seen = 0;
  for (int k = 0; k < 100; k += 10) {
    char name[16];
    std::snprintf(name, sizeof name, "%06d", k);
    SensorFrame frame;
    frame.stamp = Stamp::fromSeconds(k * 0.1);
    frame.T_ego_sensor = makePose(0, 0, 1.73, 0);
    const LidarCloud cloud = readScan(folder + name + ".bin.gz");
    frame.data = cloud;
    frame.ground = ground.update(frame);
    EXPECT_TRUE(frame.ground.measured) << k;
    const MeasurementScan scan = lidar.extract(frame);
    const auto objects = labels.find(k);
    if (objects == labels.end()) continue;
    for (const Labeled& object : objects->second) {
      if (object.bottom.head<2>().norm() > 20 || object.bottom.x() < 0 ||
          returnsWithin(cloud, object) < 20)
        continue;
      ++active;
      seen += std::any_of(
          scan.measurements.begin(), scan.measurements.end(),
          [&](const Measurement& m) { return (m.position - object.bottom.head<2>()).norm() <= 2; });
    }
  }
  EXPECT_GE(active, 15);
  EXPECT_GE(seen, active - 1) << "of " << active;
}

}  // namespace
}  // namespace perception
