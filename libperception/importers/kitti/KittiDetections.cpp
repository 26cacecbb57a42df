#include "libperception/importers/kitti/KittiDetections.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "libperception/core/LowerCase.h"
#include "libperception/importers/Importer.h"

namespace perception {
namespace {

/// KITTI's kit writes -10 where there is no angle. Angles are not always wrapped: below -2 pi too.
bool isObservationAngle(double alpha) { return alpha != -10 && std::abs(alpha) <= 4 * kPi; }

/// The layout is given by the detector's name, or its part before the first dash (kitti2d-mine).
const KittiDetectionLayout& layoutOf(const std::string& name) {
  const std::string base = name.substr(0, name.find('-'));
  std::string known;
  for (const auto& layout : kittiDetectionLayouts()) {
    if (layout.name == base) return layout;
    known += (known.empty() ? "" : ", ") + std::string(layout.name);
  }
  failUsage(fmt::format(
      "--detections: unknown detector '{}', expected one of {} (or one of these and '-anything')",
      name, known));
}

ObjectDetection detectionOf(const WorldBox& box, const Pose3& T_velo_poses) {
  const Pose3 T_velo_box = T_velo_poses * box.pose;
  const Vector3 axis = T_velo_box.linear().col(0);
  ObjectDetection object;
  object.label = box.name;
  object.score = box.score;
  ObjectDetection::SpaceBox space;
  space.bottom_center = T_velo_box * Vector3(0, 0, -box.height / 2);
  space.yaw = std::atan2(axis.y(), axis.x());
  space.length = box.length;
  space.width = box.width;
  space.height = box.height;
  object.space_box = space;
  return object;
}

/// Rows of one file that are wanted.
struct Wanted {
  std::string name, class_name, file;
};

Wanted wantedOf(const std::string& text) {
  const auto colon = text.find(':');
  const auto equals = text.find('=', colon == std::string::npos ? 0 : colon);
  if (colon == std::string::npos || equals == std::string::npos || colon == 0 ||
      equals <= colon + 1 || equals + 1 == text.size()) {
    failUsage(fmt::format("--detections '{}': expected NAME:CLASS=FILE", text));
  }
  return {text.substr(0, colon), text.substr(colon + 1, equals - colon - 1),
          text.substr(equals + 1)};
}

}  // namespace

void KittiDetections::add(const std::string& text) {
  const Wanted wanted = wantedOf(text);
  const KittiDetectionLayout& layout = layoutOf(wanted.name);
  auto detector = std::find_if(detectors_.begin(), detectors_.end(),
                               [&](const Detector& d) { return d.name == wanted.name; });
  if (detector == detectors_.end()) {
    detector = detectors_.insert(detectors_.end(), Detector{wanted.name, layout, {}, {}});
  }
  if (layout.name == std::string("boxes3d") && isJsonFile(wanted.file)) {
    for (auto& box : readNuscenesBoxes(wanted.file)) {
      if (wanted.class_name != "all" && lowerCase(box.name) != lowerCase(wanted.class_name))
        continue;
      if (wanted.class_name != "all") box.name = wanted.class_name;  // Car for car
      detector->in_world[box.frame].push_back(std::move(box));
    }
    return;
  }
  for (auto& d : readKittiDetections(wanted.file, layout.name, wanted.class_name)) {
    detector->by_frame[d.frame].push_back(std::move(d));
  }
}

bool KittiDetections::needPoses() const {
  return std::any_of(detectors_.begin(), detectors_.end(),
                     [](const Detector& d) { return !d.in_world.empty(); });
}

void KittiDetections::write(std::int64_t frame, Stamp stamp, const KittiCalibration& calibration,
                            const Pose3& T_ego_velo, const Pose3& T_poses_velo,
                            ImportLog& log) const {
  const Pose3 T_ego_camera =
      T_ego_velo * calibration.T_cam0_velo.inverse() * calibration.T_cam0_cam2;
  for (const Detector& detector : detectors_) {
    ObjectDetections found;
    found.camera = calibration.camera;
    if (detector.layout.space_boxes) found.T_ego_camera = T_ego_camera;
    const auto here = detector.by_frame.find(frame);
    if (here != detector.by_frame.end()) {
      for (const KittiLabel& d : here->second) {
        ObjectDetection& object = found.objects.emplace_back();
        object.label = d.type;
        object.score = d.score;
        if (d.image_box.x2 > d.image_box.x1 && d.image_box.y2 > d.image_box.y1)
          object.image_box = d.image_box;
        if (detector.layout.space_boxes && d.box)
          object.space_box = boxInVelodyne(*d.box, calibration);
        if (detector.layout.has_alpha && isObservationAngle(d.alpha))
          object.heading = wrapAngle(d.alpha);
      }
    }
    const auto placed = detector.in_world.find(frame);
    if (placed != detector.in_world.end()) {
      for (const WorldBox& box : placed->second)
        found.objects.push_back(detectionOf(box, T_poses_velo.inverse()));
    }
    log.sensor(detector.name, stamp, detector.layout.space_boxes ? T_ego_velo : T_ego_camera,
               std::move(found));
  }
}

}  // namespace perception
