#include "libperception/importers/kitti/KittiLabels.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "libperception/importers/ImportLog.h"
#include "libperception/importers/ImportText.h"

namespace perception {
namespace {

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

const std::vector<KittiDetectionLayout>& kittiDetectionLayouts() {
  static const std::vector<KittiDetectionLayout> kLayouts = {
      {"pointrcnn", true, true}, {"pointgnn", true, false}, {"rrc", false, false},
      {"dpm", false, true},      {"kitti3d", true, true},   {"kitti2d", false, true},
      {"boxes3d", true, true},
  };
  return kLayouts;
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

TruthObject truthOf(const KittiLabel& label, const KittiCalibration& calibration,
                    const Pose3& T_world_velo, const std::optional<LidarCloud>& cloud) {
  TruthObject o;
  o.frame = label.frame;
  o.id = label.id;
  o.type = label.type;
  // Tracking labels grade truncation 0, 1, 2 (none, partly, wholly); the object benchmark gives
  // the share itself.
  o.truncated = std::max(0.0, label.truncated > 1 ? label.truncated / 2 : label.truncated);
  o.occluded = std::max(0, label.occluded);
  o.ignore = !coveredType(label.type) || !label.box;
  if (!label.box) {  // an area of the image
    constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
    o.position.setConstant(kUnknown);
    o.yaw = o.length = o.width = o.height = kUnknown;
    const ObjectDetection::ImageBox& b = label.image_box;
    o.area = ImageArea{b.x1, b.y1, b.x2, b.y2};
    return o;
  }
  placeTruth(boxInVelodyne(*label.box, calibration), T_world_velo, o);
  if (cloud) o.lidar_points = returnsInside(*label.box, *cloud, calibration);
  return o;
}

}  // namespace perception
