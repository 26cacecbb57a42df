#include "libperception/vision/BoxGeometry.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace perception {
namespace {

constexpr double kSeamOverlap = 0.5;  // least overlap of the rows of two halves
constexpr double kCovered = 0.5;      // least share of its rows in which a box is hidden

bool isSpherical(const CameraModel& camera) {
  return camera.projection == CameraModel::Projection::kEquirectangular;
}

/// Whether the image is a panorama of the full circle.
bool isFullCircle(const CameraModel& camera) {
  return isSpherical(camera) && std::abs(camera.width - kTwoPi * camera.fx) < 2;
}

/// Azimuth [rad] of a column, to the right of the optical axis.
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
  const double fall = g.a * direction.x() + g.b * direction.y() -
                      direction.z();  // descent towards the ground per unit length
  const double height = origin.z() - g.heightAt(origin.x(), origin.y());
  if (fall <= 1e-4 || height <= 0) return std::nullopt;
  return origin + direction * (height / fall);
}

/// [-] rise of a direction per unit of horizontal distance.
double rise(const Vector3& direction) { return direction.z() / direction.head<2>().norm(); }

/// Rises of the lower and upper edge of a box, with their deviations.
struct Rises {
  double bottom = 0, top = 0;
  double edge_sigma = 0;   ///< of each edge, by the detector
  double pitch_sigma = 0;  ///< common to both
};

/// Range from the height prior and the angular height of the box, method.md (15): independent of
/// pitch and slope.
ScalarEstimate rangeByHeight(const ScalarEstimate& height, const Rises& seen) {
  const double angle = seen.top - seen.bottom;
  const double relative2 = height.variance / (height.mean * height.mean) +
                           2 * seen.edge_sigma * seen.edge_sigma / (angle * angle);
  const double range = height.mean / angle;
  return {range, range * range * relative2};
}

/// Combines both ranges by their variances; when they contradict, the object has another height and
/// the ground range is kept.
ScalarEstimate together(const ScalarEstimate& ground, const ScalarEstimate& height) {
  constexpr double kContradiction = 3;  // standard deviations
  const double d = ground.mean - height.mean, variance = ground.variance + height.variance;
  if (d * d > kContradiction * kContradiction * variance) return ground;
  ScalarEstimate both = ground;
  scalarUpdate(height, both);
  return both;
}

/// Bearings of the left and right edge, with their deviations.
void seeEdges(const ObjectDetection::ImageBox& box, const CameraModel& camera,
              const Pose3& T_ego_camera, const BoxGeometryParams& params, BoxOnGround& out) {
  const double forward = yawOf(levelFrame(T_ego_camera)), row = 0.5 * (box.y1 + box.y2);
  const auto bearing = [&](double column) {
    const Vector3 r = ray(azimuth(column, camera), row, camera, T_ego_camera);
    return wrapAngle(std::atan2(r.y(), r.x()) - forward);
  };
  out.left = bearing(box.x1);
  out.right = bearing(box.x2);
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
}

/// Range of the intersection of the ray of the lower edge with the ground, method.md (14); empty
/// beyond max_range.
std::optional<ScalarEstimate> rangeByGround(const Vector3& lowest, const Vector3& origin,
                                            const GroundPlane& ground, const Rises& seen, bool cut,
                                            const BoxGeometryParams& params) {
  const auto foot = onGround(lowest, origin, ground);
  if (!foot) return std::nullopt;
  const double r = (*foot - origin).head<2>().norm();
  if (r > params.max_range) return std::nullopt;
  const double h = origin.z() - ground.heightAt(foot->x(), foot->y());
  // sigma_r = (r^2 + h^2) / h * sigma_phi; phi: pixel, own pitch, pose pitch: method.md (14).
  double sigma =
      (r * r + h * h) / h * std::hypot(seen.edge_sigma, seen.pitch_sigma) + params.range_floor;
  if (cut) sigma += params.cut_share * r;
  return ScalarEstimate{r, sigma * sigma};
}

}  // namespace

void BoxGeometryParams::visit(ParamVisitor& v) {
  v.real("edge_sigma", edge_sigma, {0.1, 200}, "px", "noise of the left and right edge");
  v.real("edge_share", edge_share, {0, 1}, "", "share of the box's width added to edge_sigma");
  v.real("bottom_sigma", bottom_sigma, {0.1, 200}, "px", "noise of the lower edge");
  v.real("bottom_share", bottom_share, {0, 1}, "",
         "share of the box's height added to bottom_sigma");
  v.angle("pitch_sigma_deg", pitch_sigma, {0, 10},
          "noise of the line of sight relative to the ground, besides the pose's");
  v.real("max_range", max_range, {1, 500}, "m", "largest range by the ground");
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
      // The half with the better score shows more of the object: its heading is used, too.
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

HiddenEdges hiddenEdges(const ObjectDetection::ImageBox& box,
                        const std::vector<ObjectDetection::ImageBox>& others, double tolerance) {
  HiddenEdges hidden;
  for (const auto& other : others) {
    const double rows = std::min(box.y2, other.y2) - std::max(box.y1, other.y1);
    if (other.y2 <= box.y2 + tolerance || rows < kCovered * (box.y2 - box.y1)) continue;
    const auto covers = [&](double column) {
      return column > other.x1 - tolerance && column < other.x2 + tolerance;
    };
    hidden.left |= covers(box.x1);
    hidden.right |= covers(box.x2);
  }
  return hidden;
}

std::optional<BoxOnGround> boxOnGround(const ObjectDetection::ImageBox& box,
                                       const CameraModel& camera, const Pose3& T_ego_camera,
                                       const GroundPlane& ground,
                                       const PoseUncertainty& uncertainty,
                                       const BoxGeometryParams& params,
                                       const std::optional<ScalarEstimate>& height_prior) {
  if (!(box.x2 > box.x1) || !(box.y2 > box.y1) || camera.fx <= 0 || camera.fy <= 0)
    return std::nullopt;
  BoxOnGround out;
  seeEdges(box, camera, T_ego_camera, params, out);
  if (box.y2 >= camera.height - params.border) return out;

  const Vector3 origin = T_ego_camera.translation();
  // The middle of the azimuths, not of the columns: those differ by up to 1.2 deg at a tile's edge
  // (method.md 4.2).
  const double middle = 0.5 * (azimuth(box.x1, camera) + azimuth(box.x2, camera));
  const Vector3 lowest = ray(middle, box.y2, camera, T_ego_camera);
  const double box_height = box.y2 - box.y1;
  const bool upright = box_height > box.x2 - box.x1;
  const bool cut = upright && box.y2 >= camera.height - params.border_share * box_height;
  Rises seen;
  seen.bottom = rise(lowest);
  seen.top = rise(ray(middle, box.y1, camera, T_ego_camera));
  seen.edge_sigma = (params.bottom_sigma + params.bottom_share * box_height) / camera.fy;
  seen.pitch_sigma = std::hypot(params.pitch_sigma, uncertainty.sigma_pitch);

  auto range = rangeByGround(lowest, origin, ground, seen, cut, params);
  if (height_prior && !cut && box.y1 > params.border) {
    const ScalarEstimate by_height = rangeByHeight(*height_prior, seen);
    range = range ? together(*range, by_height) : by_height;
  }
  if (!range) return out;
  out.range = range->mean;
  out.range_sigma = std::sqrt(range->variance);
  // Base and height follow the rays of the box at that range: so they agree with the image for any
  // pitch.
  out.base = origin.z() + range->mean * seen.bottom;
  out.base_sigma = std::hypot(range->mean * std::hypot(seen.edge_sigma, seen.pitch_sigma),
                              seen.bottom * out.range_sigma);
  out.height = std::max(0.1, range->mean * (seen.top - seen.bottom));
  out.height_sigma = 0.1 + out.height * out.range_sigma / range->mean;
  return out;
}

}  // namespace perception
