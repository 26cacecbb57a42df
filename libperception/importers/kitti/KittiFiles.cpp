#include "libperception/importers/kitti/KittiFiles.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
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

KittiBox boxFrom(const TextRow& row, std::size_t first) {
  KittiBox box;
  box.height = row.real(first);
  box.width = row.real(first + 1);
  box.length = row.real(first + 2);
  box.bottom_center = {row.real(first + 3), row.real(first + 4), row.real(first + 5)};
  box.rotation_y = row.real(first + 6);
  return box;
}

bool isBox(const KittiBox& box) { return box.height > 0 && box.width > 0 && box.length > 0; }

ObjectDetection::ImageBox imageBoxFrom(const TextRow& row, std::size_t first) {
  return {row.real(first), row.real(first + 1), row.real(first + 2), row.real(first + 3)};
}

/// type truncated occluded alpha x1 y1 x2 y2 h w l x y z rotation_y [score], from field `type` on
void readObject(const TextRow& row, std::size_t type, KittiLabel& label) {
  row.expect(row.size() >= type + 15 && row.size() <= type + 16,
             fmt::format("{} or {}", type + 15, type + 16));
  label.type = row.text(type);
  if (row.isNumber(type)) row.fail(type, "a type such as Car");
  label.truncated = row.real(type + 1);
  label.occluded = static_cast<int>(row.integer(type + 2));
  label.alpha = row.real(type + 3);
  label.image_box = imageBoxFrom(row, type + 4);
  const KittiBox box = boxFrom(row, type + 8);
  if (isBox(box)) label.box = box;
  if (row.size() == type + 16) label.score = row.real(type + 15);
}

/// frame [id] type truncated occluded alpha x1 y1 x2 y2 h w l x y z rotation_y [score]
KittiLabel labelFrom(const TextRow& row) {
  row.expect(row.size() >= 16 && row.size() <= 18,
             "17 (label) or 18 (with score), or one less without an id");
  const bool has_id = row.isNumber(1);
  KittiLabel label;
  label.frame = row.frame(0);
  if (has_id) label.id = row.integer(1);
  readObject(row, has_id ? 2 : 1, label);
  return label;
}

/// frame,type number,x1,y1,x2,y2,score,h,w,l,x,y,z,rotation_y,alpha
KittiLabel pointRcnnFrom(const TextRow& row) {
  row.expect(row.size() == 15, "15");
  static constexpr std::array<const char*, 4> kTypes = {"", "Pedestrian", "Car", "Cyclist"};
  const std::int64_t type = row.integer(1);
  if (type < 1 || type > 3) row.fail(1, "1 (Pedestrian), 2 (Car) or 3 (Cyclist)");
  KittiLabel d;
  d.frame = row.frame(0);
  d.type = kTypes[static_cast<std::size_t>(type)];
  d.image_box = imageBoxFrom(row, 2);
  d.score = row.real(6);
  d.box = boxFrom(row, 7);
  if (!isBox(*d.box)) row.failLine("a box whose size is not positive");
  d.alpha = row.real(14);
  return d;
}

/// A 3D detector's row in either layout, told by the number of columns.
KittiLabel anyBoxFrom(const TextRow& row) {
  row.expect(row.size() >= 15 && row.size() <= 18,
             "15 (frame, type number, image box, score, h w l, x y z, rotation_y, alpha) or 17 "
             "(KITTI's label with score; 18 with an id), or a file of nuScenes' JSON");
  return row.size() == 15 ? pointRcnnFrom(row) : labelFrom(row);
}

/// frame,x1,y1,x2,y2,score; the class is that of the file.
KittiLabel rrcFrom(const TextRow& row, const std::string& class_name) {
  row.expect(row.size() == 6, "6");
  KittiLabel d;
  d.frame = row.frame(0);
  d.type = class_name;
  d.image_box = imageBoxFrom(row, 1);
  d.score = row.real(5);
  return d;
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

const std::vector<KittiDetectionLayout>& kittiDetectionLayouts() {
  static const std::vector<KittiDetectionLayout> kLayouts = {
      {"pointrcnn", true, true}, {"pointgnn", true, false}, {"rrc", false, false},
      {"dpm", false, true},      {"kitti3d", true, true},   {"kitti2d", false, true},
      {"boxes3d", true, true},
  };
  return kLayouts;
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

std::vector<Pose3> readKittiPoses(const std::string& path, const std::string& format) {
  std::vector<Pose3> poses;
  if (format == "tum") {
    for (const StampedPose& p : readTumPoses(path)) poses.push_back(p.pose);
  } else {
    forEachRow(path, kCommas, [&](const TextRow& row) {
      if (row.text(0).front() == '#') return;
      row.expect(row.size() == 12, "12 (8 are those of --poses-format tum)");
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

std::vector<KittiLabel> readKittiLabels(const std::string& path) {
  std::vector<KittiLabel> labels;
  forEachRow(path, kSpaces, [&](const TextRow& row) { labels.push_back(labelFrom(row)); });
  return labels;
}

std::vector<KittiLabel> readKittiObjectLabels(const std::string& path, std::int64_t frame) {
  std::vector<KittiLabel> labels;
  forEachRow(path, kSpaces, [&](const TextRow& row) {
    KittiLabel& label = labels.emplace_back();
    label.frame = frame;
    label.id = static_cast<std::int64_t>(labels.size()) - 1;
    readObject(row, 0, label);
  });
  return labels;
}

std::vector<KittiLabel> readKittiDetections(const std::string& path, const std::string& layout,
                                            const std::string& class_name) {
  std::vector<KittiLabel> detections;
  const bool commas = layout == "pointrcnn" || layout == "rrc";
  const bool any = layout == "boxes3d";
  forEachRow(path, any || commas ? kCommas : kSpaces, [&](const TextRow& row) {
    KittiLabel d = any                     ? anyBoxFrom(row)
                   : layout == "pointrcnn" ? pointRcnnFrom(row)
                   : layout == "rrc"       ? rrcFrom(row, class_name)
                                           : labelFrom(row);
    const bool needs_box = any || layout == "pointgnn" || layout == "kitti3d";
    if (needs_box && !d.box) row.failLine("a box whose size is not positive");
    if (class_name == "all" || d.type == class_name) detections.push_back(std::move(d));
  });
  return detections;
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

ObjectDetection::SpaceBox boxInVelodyne(const KittiBox& box, const KittiCalibration& calibration) {
  const Pose3 T_velo_cam0 = calibration.T_cam0_velo.inverse();
  // rotation_y turns the camera's x axis about its y axis, which points down. With ideal axes yaw =
  // -rotation_y - pi/2; rotating the axis itself also includes the fractions of a degree between
  // the two sensors.
  const Vector3 axis_cam(std::cos(box.rotation_y), 0, -std::sin(box.rotation_y));
  const Vector3 axis = T_velo_cam0.linear() * axis_cam;
  ObjectDetection::SpaceBox result;
  result.bottom_center = T_velo_cam0 * box.bottom_center;
  result.yaw = std::atan2(axis.y(), axis.x());
  result.length = box.length;
  result.width = box.width;
  result.height = box.height;
  return result;
}

int returnsInside(const KittiBox& box, const LidarCloud& cloud,
                  const KittiCalibration& calibration) {
  const double c = std::cos(box.rotation_y), s = std::sin(box.rotation_y);
  // Cheap test first: nothing farther from the bottom center than the box's diagonal is inside.
  const double reach2 =
      box.length * box.length / 4 + box.width * box.width / 4 + box.height * box.height;
  const Vector3 center_velo = calibration.T_cam0_velo.inverse() * box.bottom_center;
  int count = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vector3 point(cloud.x[i], cloud.y[i], cloud.z[i]);
    if (!((point - center_velo).squaredNorm() <= reach2)) continue;
    const Vector3 d = calibration.T_cam0_velo * point - box.bottom_center;
    const double along = c * d.x() - s * d.z(), across = s * d.x() + c * d.z();
    if (std::abs(along) <= box.length / 2 && std::abs(across) <= box.width / 2 && d.y() <= 0 &&
        -d.y() <= box.height) {
      ++count;
    }
  }
  return count;
}

}  // namespace perception
