#include "libperception/vision/BoxGeometry.h"

#include <algorithm>
#include <cmath>

namespace perception {
namespace {

/// Direction of a pixel in the ego frame.
Vector3 ray(double u, double v, const CameraModel& camera, const Pose3& T_ego_camera) {
  return T_ego_camera.linear() *
         Vector3((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1);
}

/// Where a ray from the camera meets the ground, ego frame; empty at or above the horizon.
std::optional<Vector3> onGround(const Vector3& direction, const Vector3& origin,
                                const GroundPlane& g) {
  const double fall =
      g.a * direction.x() + g.b * direction.y() - direction.z();  // towards the ground, per unit
  const double height = origin.z() - g.heightAt(origin.x(), origin.y());
  if (fall <= 1e-4 || height <= 0) return std::nullopt;
  return origin + direction * (height / fall);
}

}  // namespace

void BoxGeometryParams::visit(ParamVisitor& v) {
  v.real("edge_sigma", edge_sigma, {0.1, 200}, "px", "of the left and right edge");
  v.real("edge_share", edge_share, {0, 1}, "", "of the box's width, added to edge_sigma");
  v.real("bottom_sigma", bottom_sigma, {0.1, 200}, "px", "of the lower edge");
  v.real("bottom_share", bottom_share, {0, 1}, "", "of the box's height, added to bottom_sigma");
  v.angle("pitch_sigma_deg", pitch_sigma, {0, 10},
          "of the line of sight against the ground, beside the pose's own");
  v.real("range_floor", range_floor, {0, 20}, "m", "added to the range's deviation");
  v.real("border", border, {0, 100}, "px",
         "edges this near to the image's border are cut off by it");
  v.real("border_share", border_share, {0, 1}, "",
         "of the box's height: a lower edge this near to the border may be one of a cut-off box");
  v.real("cut_share", cut_share, {0, 5}, "", "of the range, added to its deviation for such a box");
  v.real("max_range", max_range, {1, 500}, "m", "beyond it the ground range is not used");
}

Pose3 levelFrame(const Pose3& T_ego_camera) {
  const Vector3 forward = T_ego_camera.linear().col(2);
  const Vector3 t = T_ego_camera.translation();
  return makePose(t.x(), t.y(), t.z(), std::atan2(forward.y(), forward.x()));
}

std::optional<BoxOnGround> boxOnGround(const ObjectDetection::ImageBox& box,
                                       const CameraModel& camera, const Pose3& T_ego_camera,
                                       const GroundPlane& ground,
                                       const PoseUncertainty& uncertainty,
                                       const BoxGeometryParams& params) {
  if (!(box.x2 > box.x1) || !(box.y2 > box.y1) || camera.fx <= 0 || camera.fy <= 0)
    return std::nullopt;
  const Pose3 level = levelFrame(T_ego_camera);
  const double forward = yawOf(level);
  const double middle = 0.5 * (box.x1 + box.x2), row = 0.5 * (box.y1 + box.y2);
  const auto bearing = [&](double u) {
    const Vector3 r = ray(u, row, camera, T_ego_camera);
    return wrapAngle(std::atan2(r.y(), r.x()) - forward);
  };
  BoxOnGround out;
  out.left = bearing(box.x1);
  out.right = bearing(box.x2);
  out.left_seen = box.x1 > params.border;
  out.right_seen = box.x2 < camera.width - params.border;
  // d(bearing)/d(pixel) = cos^2(bearing) / fx.
  const double edge_sigma = params.edge_sigma + params.edge_share * (box.x2 - box.x1);
  out.left_sigma = edge_sigma * std::pow(std::cos(out.left), 2) / camera.fx;
  out.right_sigma = edge_sigma * std::pow(std::cos(out.right), 2) / camera.fx;
  if (box.y2 >= camera.height - params.border) return out;

  const Vector3 origin = T_ego_camera.translation();
  const auto foot = onGround(ray(middle, box.y2, camera, T_ego_camera), origin, ground);
  if (!foot) return out;
  const double range = (*foot - origin).head<2>().norm();
  if (range > params.max_range) return out;
  const double h = origin.z() - ground.heightAt(foot->x(), foot->y());
  // sigma_r = (r^2 + h^2) / h * sigma_phi; phi: pixel, own pitch, pose pitch (VISION_NOTES 3).
  const double sigma_phi = std::sqrt(
      std::pow((params.bottom_sigma + params.bottom_share * (box.y2 - box.y1)) / camera.fy, 2) +
      params.pitch_sigma * params.pitch_sigma + uncertainty.sigma_pitch * uncertainty.sigma_pitch);
  out.range = range;
  out.range_sigma = (range * range + h * h) / h * sigma_phi + params.range_floor;
  if (box.y2 >= camera.height - params.border_share * (box.y2 - box.y1))
    out.range_sigma += params.cut_share * range;
  // Height of the upper edge over the foot at that range.
  const Vector3 top = ray(middle, box.y1, camera, T_ego_camera);
  const double flat = top.head<2>().norm();
  out.height = std::max(0.1, origin.z() + range * top.z() / flat - foot->z());
  out.height_sigma = 0.1 + out.height * out.range_sigma / range;
  return out;
}

}  // namespace perception
