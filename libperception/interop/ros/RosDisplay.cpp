#include "libperception/interop/ros/RosDisplay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "libperception/scene/ClassColors.h"

namespace perception::ros {
namespace {

constexpr double kMoves = 0.5;           // [m/s] from which on an arrow is shown
constexpr double kArrowSeconds = 1;      // whose length is the way of this time
constexpr double kMarkTextHeight = 0.8;  // [m]
constexpr float kFaintest = 0.25F;       // alpha

Marker markOf(const SceneObject& object, const Header& header, const char* ns, Marker::Type type) {
  Marker mark;
  mark.header = header;
  mark.ns = ns;
  mark.id = static_cast<std::int32_t>(object.id & 0x7FFFFFFF);
  mark.type = type;
  return mark;
}

void addMarks(const SceneObject& object, const Header& header,
              const std::vector<std::string>& class_names, std::vector<Marker>& marks) {
  const std::string& name = class_names[object.class_id];
  const Color color = colorOfClass(name, static_cast<int>(object.class_id));
  const auto part = [](int value) { return static_cast<float>(value) / 255; };
  const std::array<float, 4> shade{part(color.r), part(color.g), part(color.b),
                                   std::max(kFaintest, static_cast<float>(object.existence))};
  const Vector3& at = object.position;
  Marker box = markOf(object, header, "objects", Marker::kCube);
  box.pose = messageOf(makePose(at.x(), at.y(), at.z() + object.height / 2, object.yaw));
  box.scale = {object.length, object.width, object.height};
  box.color = shade;
  marks.push_back(box);
  Marker text = markOf(object, header, "texts", Marker::kText);
  text.pose = messageOf(makePose(at.x(), at.y(), at.z() + object.height + kMarkTextHeight, 0));
  text.scale = {kMarkTextHeight, kMarkTextHeight, kMarkTextHeight};
  text.color = {1, 1, 1, 1};
  text.text = fmt::format("{} {}{}\n{:.1f} m/s", name, object.id, object.classified ? "" : "?",
                          object.velocity.norm());
  marks.push_back(text);
  const double speed = object.velocity.norm();
  if (!(speed >= kMoves)) return;
  Marker arrow = markOf(object, header, "velocities", Marker::kArrow);
  arrow.pose = messageOf(makePose(at.x(), at.y(), at.z() + object.height,
                                  std::atan2(object.velocity.y(), object.velocity.x())));
  arrow.scale = {speed * kArrowSeconds, 0.2, 0.2};
  arrow.color = shade;
  marks.push_back(arrow);
}

}  // namespace

MarkerArray marksOf(const Scene& scene, const std::string& frame,
                    const std::vector<std::string>& class_names) {
  const Header header{scene.stamp, frame};
  MarkerArray array;
  Marker all;
  all.header = header;
  all.action = Marker::kDeleteAll;
  array.markers.push_back(all);
  for (const SceneObject& object : scene.objects)
    addMarks(object, header, class_names, array.markers);
  return array;
}

OccupancyGrid mapOf(const Scene& scene, const std::string& frame,
                    const std::vector<GridCell>& cells, double resolution, double reach,
                    std::string& data) {
  const Vector3 vehicle = scene.ego.T_world_ego.translation();
  const auto corner = [&](double v) { return std::floor((v - reach) / resolution) * resolution; };
  const double x0 = corner(vehicle.x()), y0 = corner(vehicle.y());
  const auto side = static_cast<std::uint32_t>(std::ceil(2 * reach / resolution)) + 1;
  OccupancyGrid map;
  map.header = {scene.stamp, frame};
  map.resolution = static_cast<float>(resolution);
  map.width = map.height = side;
  map.origin.position = {x0, y0, vehicle.z()};
  data.assign(std::size_t{side} * side, static_cast<char>(-1));
  const auto mark = [&](const GridCell& cell) {
    const double p = 100 / (1 + std::exp(-cell.log_odds));
    const auto value = static_cast<char>(std::lround(p));
    const auto index = [&](double v, double v0) {
      return static_cast<std::int64_t>(std::floor((v - v0) / resolution + 1e-6));
    };
    const Vector3 half = cell.size / 2;  // cells that are alike may be one large one
    const auto last = static_cast<std::int64_t>(side) - 1;
    const auto inside = [&](std::int64_t i) { return std::clamp<std::int64_t>(i, 0, last); };
    const double inner = resolution / 2;
    const auto c0 = index(cell.center.x() - half.x() + inner, x0);
    const auto c1 = index(cell.center.x() + half.x() - inner, x0);
    const auto r0 = index(cell.center.y() - half.y() + inner, y0);
    const auto r1 = index(cell.center.y() + half.y() - inner, y0);
    if (c1 < 0 || r1 < 0 || c0 > last || r0 > last) return;
    for (std::int64_t r = inside(r0); r <= inside(r1); ++r) {
      for (std::int64_t c = inside(c0); c <= inside(c1); ++c) {
        char& known = data[static_cast<std::size_t>(r) * side + static_cast<std::size_t>(c)];
        known = std::max(known, value);
      }
    }
  };
  for (const GridCell& cell : cells) mark(cell);
  map.data = data;
  return map;
}

}  // namespace perception::ros
