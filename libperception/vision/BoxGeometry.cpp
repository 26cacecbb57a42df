#include "libperception/vision/BoxGeometry.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace perception {
namespace {

constexpr double kSeamOverlap = 0.5;  // of the rows of two halves of one object

bool isSpherical(const CameraModel& camera) {
  return camera.projection == CameraModel::Projection::kEquirectangular;
}

/// A panorama that closes: what leaves it on the right comes in on the left.
bool isFullCircle(const CameraModel& camera) {
  return isSpherical(camera) && std::abs(camera.width - kTwoPi * camera.fx) < 2;
}

/// [rad] of a column to the right of the optical axis.
double azimuth(double u, const CameraModel& camera) {
  const double x = (u - camera.cx) / camera.fx;
  return isSpherical(camera) ? x : std::atan(x);
}

/// Direction of a pixel in the ego frame, the column given by its azimuth.
Vector3 ray(double azimuth, double v, const CameraModel& camera, const Pose3& T_ego_camera) {
  const double y = (v - camera.cy) / camera.fy;
  const Vector3 optical =
      isSpherical(camera)
          ? Vector3(std::cos(y) * std::sin(azimuth), std::sin(y), std::cos(y) * std::cos(azimuth))
          : Vector3(std::tan(azimuth), y, 1);
  return T_ego_camera.linear() * optical;
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
  v.real(
      "border_share", border_share, {0, 1}, "",
      "of an upright box's height: a lower edge so near to the border may be of a cut-off person");
  v.real("cut_share", cut_share, {0, 5}, "", "of the range, added to its deviation for such a box");
  v.real("max_range", max_range, {1, 500}, "m", "beyond it the ground range is not used");
}

Pose3 levelFrame(const Pose3& T_ego_camera) {
  const Vector3 forward = T_ego_camera.linear().col(2);
  const Vector3 t = T_ego_camera.translation();
  return makePose(t.x(), t.y(), t.z(), std::atan2(forward.y(), forward.x()));
}

std::vector<std::size_t> joinSeam(const CameraModel& camera, double border,
                                  std::vector<ObjectDetection>& objects) {
  std::vector<std::size_t> index(objects.size());
  std::iota(index.begin(), index.end(), std::size_t{0});
  if (!isFullCircle(camera)) return index;
  const auto sameRows = [](const ObjectDetection::ImageBox& a, const ObjectDetection::ImageBox& b) {
    const double both = std::min(a.y2, b.y2) - std::max(a.y1, b.y1);
    return both >= kSeamOverlap * (std::max(a.y2, b.y2) - std::min(a.y1, b.y1));
  };
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (!objects[i].image_box || objects[i].image_box->x2 < camera.width - border) continue;
    auto& left = *objects[i].image_box;
    for (std::size_t k = 0; k < objects.size(); ++k) {
      if (k == i || !objects[k].image_box || objects[k].label != objects[i].label) continue;
      const auto right = *objects[k].image_box;
      if (right.x1 > border || !sameRows(left, right)) continue;
      left = {left.x1, std::min(left.y1, right.y1), right.x2 + camera.width,
              std::max(left.y2, right.y2)};
      // The half with the better score saw more of the object: its heading, too.
      if (objects[k].score > objects[i].score) {
        objects[i].score = objects[k].score;
        objects[i].heading = objects[k].heading;
      }
      objects.erase(objects.begin() + static_cast<std::ptrdiff_t>(k));
      index.erase(index.begin() + static_cast<std::ptrdiff_t>(k));
      if (k < i) --i;
      break;
    }
  }
  return index;
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
  // The middle of the azimuths, not of the columns: those differ by up to 1.2 deg at a tile's edge
  // (VISION_NOTES 3).
  const double azimuth1 = azimuth(box.x1, camera), azimuth2 = azimuth(box.x2, camera);
  const double middle = 0.5 * (azimuth1 + azimuth2), row = 0.5 * (box.y1 + box.y2);
  const auto bearing = [&](double column_azimuth) {
    const Vector3 r = ray(column_azimuth, row, camera, T_ego_camera);
    return wrapAngle(std::atan2(r.y(), r.x()) - forward);
  };
  BoxOnGround out;
  out.left = bearing(azimuth1);
  out.right = bearing(azimuth2);
  const bool closed = isFullCircle(camera);
  out.left_seen = closed || box.x1 > params.border;
  out.right_seen = closed || box.x2 < camera.width - params.border;
  // d(bearing)/d(pixel): cos^2(bearing) / fx, on a sphere 1 / fx.
  const double edge_sigma = params.edge_sigma + params.edge_share * (box.x2 - box.x1);
  const auto perPixel = [&](double b) {
    return (isSpherical(camera) ? 1 : std::pow(std::cos(b), 2)) / camera.fx;
  };
  out.left_sigma = edge_sigma * perPixel(out.left);
  out.right_sigma = edge_sigma * perPixel(out.right);
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
  const double box_height = box.y2 - box.y1;
  const bool upright = box_height > box.x2 - box.x1;
  if (upright && box.y2 >= camera.height - params.border_share * box_height)
    out.range_sigma += params.cut_share * range;
  // Height of the upper edge over the foot at that range.
  const Vector3 top = ray(middle, box.y1, camera, T_ego_camera);
  const double flat = top.head<2>().norm();
  out.height = std::max(0.1, origin.z() + range * top.z() / flat - foot->z());
  out.height_sigma = 0.1 + out.height * out.range_sigma / range;
  return out;
}

}  // namespace perception
