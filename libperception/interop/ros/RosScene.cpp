#include "libperception/interop/ros/RosScene.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "libperception/interop/ros/RosSensors.h"

namespace perception::ros {
namespace {

/// [rad^2] about yaw, of an axis whose front is known with a probability.
double yawVariance(const SceneObject& object) {
  const double axis = object.sd_yaw * object.sd_yaw;
  return object.has_yaw ? axis + (1 - object.p_front) * kPi * kPi : axis;
}

Detection3D detectionOf(const SceneObject& object, const Header& header,
                        const std::vector<std::string>& class_names) {
  constexpr double kLeast = 0.01;  // probability of classes that are named
  Detection3D d;
  d.header = header;
  const Pose3 T = makePose(object.position.x(), object.position.y(),
                           object.position.z() + object.height / 2, object.yaw);
  d.center = messageOf(T);
  d.size = {object.length, object.width, object.height};
  d.id = std::to_string(object.id);
  const double variances[] = {object.sd_x * object.sd_x, object.sd_y * object.sd_y,
                              yawVariance(object)};
  for (std::size_t c = 0; c < object.class_probability.size(); ++c) {
    if (object.class_probability[c] < kLeast) continue;
    ObjectHypothesis h;
    h.class_id = class_names[c];
    h.score = object.class_probability[c] * object.existence;
    h.pose = d.center;
    for (const auto& [at, k] : {std::pair(0, 0), std::pair(7, 1), std::pair(35, 2)})
      h.covariance[static_cast<std::size_t>(at)] = variances[k];
    d.results.push_back(std::move(h));
  }
  return d;
}

}  // namespace

Detection3DArray messageOf(const Scene& scene, const std::vector<std::string>& class_names) {
  Detection3DArray array;
  array.header = {scene.stamp, kWorld};
  for (const SceneObject& object : scene.objects)
    array.detections.push_back(detectionOf(object, array.header, class_names));
  return array;
}

ObjectDetections objectsOf(const Detection3DArray& message) {
  ObjectDetections out;
  for (const Detection3D& given : message.detections) {
    const std::string& frame = given.header.frame_id;
    if (!frame.empty() && frame != message.header.frame_id)
      throw std::runtime_error(fmt::format("a box in frame \"{}\" of an array in \"{}\"", frame,
                                           message.header.frame_id));
    ObjectDetection object;
    object.label = "object";
    const auto best =
        std::max_element(given.results.begin(), given.results.end(),
                         [](const auto& a, const auto& b) { return a.score < b.score; });
    if (best != given.results.end()) object.label = best->class_id, object.score = best->score;
    for (const ObjectHypothesis& h : given.results)
      object.class_scores.emplace_back(h.class_id, h.score);
    const Pose3 center = poseOf(given.center);
    ObjectDetection::SpaceBox box;
    box.bottom_center = center * Vector3(0, 0, -given.size[2] / 2);
    box.yaw = yawOf(center);
    box.length = given.size[0], box.width = given.size[1], box.height = given.size[2];
    object.space_box = box;
    out.objects.push_back(std::move(object));
  }
  return out;
}

}  // namespace perception::ros
