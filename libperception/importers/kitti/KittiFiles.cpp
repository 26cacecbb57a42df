#include "libperception/importers/kitti/KittiFiles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "libperception/core/Error.h"
#include "libperception/importers/ImportText.h"

namespace perception {

namespace {

using Matrix34 = Eigen::Matrix<double, 3, 4>;

/// The size of KITTI's rectified images depends on the day and is not in the calibration files; the
/// focal length identifies the day (image sizes of the raw data's S_rect_02).
struct ImageSize {
  double fx;          ///< [px]
  int width, height;  ///< [px]
};
constexpr ImageSize kImageSizes[] = {{721.5377, 1242, 375},   // 2011_09_26
                                     {707.0493, 1224, 370},   // 2011_09_28
                                     {718.3351, 1238, 374},   // 2011_09_29
                                     {707.0912, 1226, 370},   // 2011_09_30
                                     {718.8560, 1241, 376}};  // 2011_10_03

void setCamera(const TextRow& row, const Matrix34& P2, KittiCalibration& calibration) {
  if (!setKittiCamera(P2, calibration)) row.failLine("P2 is not K [I | t] of a camera");
}

}  // namespace

bool setKittiCamera(const Eigen::Matrix<double, 3, 4>& P2, KittiCalibration& calibration) {
  CameraModel& c = calibration.camera;
  c.fx = P2(0, 0);
  c.fy = P2(1, 1);
  c.cx = P2(0, 2);
  c.cy = P2(1, 2);
  if (!(c.fx > 0) || !(c.fy > 0) || P2(2, 2) != 1) return false;
  // P2 = K [I | t]: a point p of cam0 is p + t in cam2.
  const double tz = P2(2, 3);
  const Vector3 t((P2(0, 3) - c.cx * tz) / c.fx, (P2(1, 3) - c.cy * tz) / c.fy, tz);
  calibration.T_cam0_cam2.translation() = -t;
  const auto* best = std::min_element(
      std::begin(kImageSizes), std::end(kImageSizes),
      [&](const auto& a, const auto& b) { return std::abs(a.fx - c.fx) < std::abs(b.fx - c.fx); });
  c.width = best->width;
  c.height = best->height;
  return true;
}

KittiCalibration readKittiCalibration(const std::string& path) {
  KittiCalibration calibration;
  std::optional<Pose3> rectification, velo_to_cam;
  bool has_camera = false;
  forEachRow(path, " \t\r:", [&](const TextRow& row) {
    const std::string name = row.text(0);
    // The tracking benchmark's own names and those of the object benchmark.
    if (name == "P2") {
      setCamera(row, row.matrix34(1), calibration);
      has_camera = true;
    } else if (name == "R0_rect" || name == "R_rect") {
      rectification = row.rotation33(1);
    } else if (name == "Tr_velo_to_cam" || name == "Tr_velo_cam") {
      velo_to_cam = row.pose34(1);
    } else if ((name == "Tr_imu_to_velo" || name == "Tr_imu_velo") && row.size() > 1) {
      calibration.T_velo_imu = row.pose34(1);
    }
  });
  const auto need = [&](bool there, const char* name) {
    if (!there)
      throw DataError(fmt::format("{}: no line {}, expected a KITTI calibration", path, name));
  };
  need(has_camera, "P2");
  need(rectification.has_value(), "R0_rect");
  need(velo_to_cam.has_value(), "Tr_velo_to_cam");
  calibration.T_cam0_velo = *rectification * *velo_to_cam;
  return calibration;
}

Pose3 levelVelodyne(const KittiCalibration& calibration) {
  const Vector3 up = -calibration.T_cam0_velo.linear().row(1).transpose();  // in the Velodyne frame
  const Vector3 left = up.cross(Vector3::UnitX()).normalized();
  Pose3 T_ego_velo = Pose3::Identity();
  T_ego_velo.linear() << left.cross(up).transpose(), left.transpose(), up.transpose();
  T_ego_velo.translation().z() = kKittiVelodyneHeight;
  return T_ego_velo;
}

std::vector<Pose3> readKittiPoses(const std::string& path, const std::string& format) {
  std::vector<Pose3> poses;
  if (format == "tum") {
    for (const StampedPose& p : readTumPoses(path)) poses.push_back(p.pose);
  } else {
    forEachRow(path, kCommas, [&](const TextRow& row) {
      if (row.text(0).front() == '#') return;
      row.expect(row.size() == 12 || row.size() == 16, "12 (8 are those of --poses-format tum)");
      poses.push_back(row.pose34(0));
    });
  }
  if (poses.empty()) throw DataError(fmt::format("{}: no pose in it", path));
  return poses;
}

std::vector<Pose3> readKittiOxts(const std::string& path) {
  return readKittiOxts(std::vector<std::string>{path});
}

std::vector<Pose3> readKittiOxts(const std::vector<std::string>& paths) {
  constexpr double kEarthRadius = 6378137;  // [m] as in the development kit
  std::vector<Pose3> poses;
  double scale = 0;
  const auto add = [&](const TextRow& row) {
    row.expect(row.size() >= 6, "at least 6: lat lon alt roll pitch yaw ...");
    const double lat = row.real(0), lon = row.real(1);
    if (std::abs(lat) >= 90) row.fail(0, "a latitude in degrees");
    if (std::abs(lon) > 360) row.fail(1, "a longitude in degrees");
    for (std::size_t i = 3; i < 6; ++i)
      if (std::abs(row.real(i)) > 2 * kPi) row.fail(i, "an angle in radians");
    if (poses.empty()) scale = std::cos(radians(lat));
    const double x = scale * radians(lon) * kEarthRadius;
    const double y = scale * kEarthRadius * std::log(std::tan(radians(90 + lat) / 2));
    poses.push_back(makePose(x, y, row.real(2), row.real(5), row.real(4), row.real(3)));
  };
  for (const std::string& path : paths) {
    const std::size_t before = poses.size();
    forEachRow(path, kSpaces, add);
    if (poses.size() == before) throw DataError(fmt::format("{}: no pose in it", path));
    if (paths.size() > 1 && poses.size() != before + 1)
      throw DataError(fmt::format("{}: {} lines, expected one", path, poses.size() - before));
  }
  return poses;
}

LidarCloud readKittiScan(const std::string& path) {
  constexpr std::size_t kPointBytes = 16;
  constexpr std::size_t kMostBytes = kPointBytes
                                     << 24;  // 16 million points: more than any scanner has
  const std::string bytes = readBytes(path, kMostBytes);
  if (bytes.size() % kPointBytes != 0) {
    throw DataError(fmt::format("{}: {} bytes, expected 16 a point (float32 x, y, z, intensity)",
                                path, bytes.size()));
  }
  LidarCloud cloud;
  const std::size_t n = bytes.size() / kPointBytes;
  for (auto* values : {&cloud.x, &cloud.y, &cloud.z, &cloud.intensity}) values->resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    float point[4];
    std::memcpy(point, bytes.data() + i * kPointBytes, kPointBytes);
    cloud.x[i] = point[0];
    cloud.y[i] = point[1];
    cloud.z[i] = point[2];
    cloud.intensity[i] = point[3];
  }
  cloud.max_range = 120;  // [m] Velodyne HDL-64E, data sheet
  return cloud;
}

}  // namespace perception
