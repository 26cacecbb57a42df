#include "libperception/lidar/EgoPoints.h"

namespace perception {

void PointParams::visit(ParamVisitor& v) {
  v.real("range_min", range_min, {0, 10}, "m", "horizontal range below which returns are dropped");
  v.real("range_max", range_max, {5, 300}, "m",
         "horizontal range beyond which returns are dropped");
  v.real("vehicle_front", vehicle_front, {0, 20}, "m", "own body ahead of the ego origin");
  v.real("vehicle_rear", vehicle_rear, {0, 20}, "m", "own body behind the ego origin");
  v.real("vehicle_side", vehicle_side, {0, 5}, "m", "own body to each side of the ego origin");
  v.real("vehicle_top", vehicle_top, {0, 6}, "m", "own body above the ground");
  v.boolean("only_objects", only_objects,
            "returns that the scanner itself labels as object, where it labels at all (SPEC 1)");
  v.require(range_min < range_max, "range_min must be below range_max");
}

namespace {

bool ownProcessingDropsIt(std::uint8_t label, bool only_objects) {
  if (only_objects) return label != static_cast<std::uint8_t>(PointLabel::kObject);
  return label == static_cast<std::uint8_t>(PointLabel::kRain) ||
         label == static_cast<std::uint8_t>(PointLabel::kDirt);
}

}  // namespace

EgoPoints usablePoints(const SensorFrame& frame, const PointParams& params) {
  EgoPoints points;
  points.sensor = frame.T_ego_sensor.translation();
  const auto* cloud = std::get_if<LidarCloud>(&frame.data);
  if (cloud == nullptr) return points;
  const std::size_t count = cloud->size();
  points.x.resize(count), points.y.resize(count), points.z.resize(count),
      points.source.resize(count);

  const Eigen::Matrix3f R = frame.T_ego_sensor.linear().cast<float>();
  const Eigen::Vector3f t = frame.T_ego_sensor.translation().cast<float>();
  const auto near2 = static_cast<float>(params.range_min * params.range_min);
  const auto far2 = static_cast<float>(params.range_max * params.range_max);
  const auto front = static_cast<float>(params.vehicle_front),
             rear = static_cast<float>(-params.vehicle_rear);
  const auto side = static_cast<float>(params.vehicle_side),
             top = static_cast<float>(params.vehicle_top);
  constexpr float kBeyondAnyLidar2 = 1e3f * 1e3f;  // [m^2]

  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const float px = cloud->x[i], py = cloud->y[i], pz = cloud->z[i];
    const float range2 = px * px + py * py + pz * pz;
    if (!(range2 < kBeyondAnyLidar2)) {  // also NaN
      ++points.dropped;
      continue;
    }
    if (!cloud->label.empty() && ownProcessingDropsIt(cloud->label[i], params.only_objects))
      continue;
    const float x = R(0, 0) * px + R(0, 1) * py + R(0, 2) * pz + t.x();
    const float y = R(1, 0) * px + R(1, 1) * py + R(1, 2) * pz + t.y();
    const float z = R(2, 0) * px + R(2, 1) * py + R(2, 2) * pz + t.z();
    const float dx = x - t.x(), dy = y - t.y(), horizontal2 = dx * dx + dy * dy;
    if (horizontal2 < near2 || horizontal2 > far2) continue;
    if (x < front && x > rear && std::abs(y) < side && z < top) continue;
    points.x[kept] = x, points.y[kept] = y, points.z[kept] = z;
    points.source[kept++] = static_cast<std::uint32_t>(i);
  }
  points.x.resize(kept), points.y.resize(kept), points.z.resize(kept), points.source.resize(kept);
  return points;
}

}  // namespace perception
