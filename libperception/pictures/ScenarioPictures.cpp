#include "libperception/pictures/ScenarioPictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "gui-offscreen/drawing/Canvas.h"
#include "gui-offscreen/drawing/Palette.h"
#include "libperception/pictures/ScenarioDrawing.h"
#include "libperception/simulation/world/World.h"

namespace perception {
namespace {

constexpr Color kAsphalt{214, 214, 218}, kGrassColor{238, 242, 230}, kWallColor{150, 140, 130};
constexpr Color kLeafColor{120, 160, 90};

bool vehicleKind(ObjectKind k) {
  return k == ObjectKind::kCar || k == ObjectKind::kVan || k == ObjectKind::kBus;
}

Color colorOfKind(ObjectKind k) {
  if (vehicleKind(k)) return colorOfClass(k == ObjectKind::kBus ? "bus" : "car", 0);
  return colorOfClass(k == ObjectKind::kCyclist ? "cyclist" : "pedestrian", 0);
}

/// Extent of the view [m]: paths near that of the ego.
struct Extent {
  Vector2 low = Vector2::Constant(1e9), high = Vector2::Constant(-1e9);
  void add(const Vector2& p) { low = low.cwiseMin(p), high = high.cwiseMax(p); }
};

Extent extentOf(const World& world) {
  const Scenario& s = world.scenario();
  Extent ego, all;
  for (std::size_t i = 0; i < s.ego.waypoints.x.size(); ++i) {
    ego.add({s.ego.waypoints.x[i], s.ego.waypoints.y[i]});
  }
  constexpr double kAside = 22, kAhead = 26;  // [m]
  all = ego;
  for (const ObjectParams& o : s.objects) {
    if (!isRoadUser(o.kind)) continue;
    for (std::size_t i = 0; i < o.waypoints.x.size(); ++i) {
      all.add(Vector2(o.waypoints.x[i], o.waypoints.y[i])
                  .cwiseMax(ego.low - Vector2(5, kAside))
                  .cwiseMin(ego.high + Vector2(kAhead, kAside)));
    }
  }
  all.low -= Vector2::Constant(4), all.high += Vector2::Constant(4);
  return all;
}

void drawStanding(Canvas& canvas, const Scale& scale, const World& world) {
  const Scenario& s = world.scenario();
  for (const RoadParams& road : s.roads) {
    for (std::size_t i = 0; i + 1 < road.x.size(); ++i) {
      const Vector2 a(road.x[i], road.y[i]), b(road.x[i + 1], road.y[i + 1]);
      const double length = (b - a).norm(), heading = std::atan2(b.y() - a.y(), b.x() - a.x());
      drawPolygon(canvas, scale, footprint(a, heading, length, 0, road.width), kAsphalt);
    }
  }
  for (std::size_t i = 0; i < world.objects(); ++i) {
    const ObjectParams& o = s.objects[i];
    if (isRoadUser(o.kind)) continue;
    const ObjectState state = world.object(i, 0);
    const Vector2 p = state.T_world_object.translation().head<2>();
    const auto corners =
        footprint(p, yawOf(state.T_world_object), .5 * o.length, .5 * o.length, o.width);
    if (o.kind == ObjectKind::kBush) {
      canvas.disc(scale(p), std::max(2.0, .5 * scale.pixels * o.width), kLeafColor);
    } else if (o.kind == ObjectKind::kPole) {
      canvas.disc(scale(p), 2, kInk);
    } else {
      drawPolygon(canvas, scale, corners, kWallColor);
    }
  }
}

void drawBody(Canvas& canvas, const Scale& scale, const ObjectParams& o, const ObjectState& state,
              bool filled) {
  const Color color = colorOfKind(o.kind);
  const Vector2 p = state.T_world_object.translation().head<2>();
  if (!vehicleKind(o.kind)) {
    const double radius = std::max(2.2, .5 * scale.pixels * o.width);
    canvas.disc(scale(p), radius, filled ? color : color.withAlpha(.35));
    return;
  }
  const auto corners =
      footprint(p, yawOf(state.T_world_object), .5 * o.length, .5 * o.length, o.width);
  drawPolygon(canvas, scale, corners, color.withAlpha(filled ? .9 : .2));
  drawOutline(canvas, scale, corners, color, 1);
}

void drawWay(Canvas& canvas, const Scale& scale, const std::vector<Vector2>& way,
             const Color& color, double thickness) {
  for (std::size_t i = 0; i + 2 < way.size(); ++i) {
    canvas.line(scale(way[i]), scale(way[i + 1]), color, thickness);
  }
  // The arrow needs some length to have a direction.
  for (std::size_t i = way.size(); i-- > 0;) {
    if ((way.back() - way[i]).norm() * scale.pixels < 8) continue;
    canvas.arrow(scale(way[i]), scale(way.back()), color, thickness);
    return;
  }
}

void drawScaleBar(Canvas& canvas, const Rect& area, const Scale& scale) {
  double meters = 5;
  while (meters * scale.pixels < 40) meters *= 2;
  const Vector2 from(area.x + 10, area.bottom() - 10),
      to(from.x() + meters * scale.pixels, from.y());
  canvas.rectangle({from.x() - 5, from.y() - 17, to.x() - from.x() + 10, 24}, kPaper.withAlpha(.8));
  canvas.line(from, to, kInk, 2);
  canvas.text({from.x(), from.y() - 5}, fmt::format("{:g} m", meters), 9, kInk);
}

std::vector<Vector2> wayOf(const World& world, std::optional<std::size_t> object) {
  constexpr double kStep = 0.25;  // [s] of the lines
  std::vector<Vector2> way;
  for (double t = 0; t <= world.scenario().params.duration; t += kStep) {
    const Pose3 pose = object ? world.object(*object, t).T_world_object : world.ego(t).T_world_ego;
    way.push_back(pose.translation().head<2>());
  }
  return way;
}

void drawWorld(Canvas& canvas, const Scale& scale, const World& world) {
  const Scenario& s = world.scenario();
  const double half_time = .5 * s.params.duration;
  drawStanding(canvas, scale, world);
  for (std::size_t i = 0; i < world.objects(); ++i) {
    const ObjectParams& o = s.objects[i];
    const bool moves = o.waypoints.t.size() > 1;
    if (!isRoadUser(o.kind)) continue;
    if (moves) {
      drawWay(canvas, scale, wayOf(world, i), colorOfKind(o.kind), 1.3);
      drawBody(canvas, scale, o, world.object(i, 0), false);
    }
    drawBody(canvas, scale, o, world.object(i, half_time), moves);
  }
  drawWay(canvas, scale, wayOf(world, {}), kEgo, 2.2);
  const Pose3 ego = world.ego(half_time).T_world_ego;
  drawPolygon(canvas, scale,
              footprint(ego.translation().head<2>(), yawOf(ego), kEgoFront, kEgoRear, kEgoWidth),
              kEgo);
}

void drawScenario(Canvas& canvas, const Rect& area, const NamedScenario& named) {
  const World world(named.scenario);
  const Scenario& s = world.scenario();
  const Extent extent = extentOf(world);
  const Vector2 size = extent.high - extent.low;
  canvas.text({area.x + 2, area.y + 11}, named.name, 12, kInk, true);
  canvas.text({area.x + 4 + Canvas::textWidth(named.name + " ", 12, true), area.y + 11},
              fmt::format("{:g} s", s.params.duration), 10, kMutedInk);
  std::string text = s.params.description;
  while (!text.empty() && Canvas::textWidth(text, 9) > area.width - 4) text.pop_back();
  canvas.text({area.x + 2, area.y + 25}, text, 9, kMutedInk);
  // A long street is split into strips, the first one on top.
  const Rect view{area.x, area.y + 30, area.width, area.height - 34};
  const int strips = std::clamp(
      static_cast<int>(std::lround(std::sqrt(size.x() / size.y() * view.height / view.width))), 1,
      4);
  constexpr double kBetween = 4;  // [px]
  const double height = (view.height - kBetween * (strips - 1)) / strips;
  for (int i = 0; i < strips; ++i) {
    const Rect strip{view.x, view.y + i * (height + kBetween), view.width, height};
    Scale scale;
    scale.middle = {extent.low.x() + size.x() * (i + .5) / strips, extent.low.y() + .5 * size.y()};
    scale.at = {strip.x + .5 * strip.width, strip.y + .5 * strip.height};
    scale.pixels = std::min(strip.width / (size.x() / strips), strip.height / size.y());
    canvas.clip(strip);
    canvas.rectangle(strip, s.roads.empty() ? kAsphalt : kGrassColor);
    drawWorld(canvas, scale, world);
    if (i == strips - 1) drawScaleBar(canvas, strip, scale);
    canvas.unclip();
  }
}

void drawLegend(Canvas& canvas, const Vector2& at) {
  const std::array<std::pair<const char*, Color>, 7> entries = {
      {{"vehicle with the sensors", kEgo},
       {"car, van", colorOfKind(ObjectKind::kCar)},
       {"bus", colorOfKind(ObjectKind::kBus)},
       {"cyclist", colorOfKind(ObjectKind::kCyclist)},
       {"pedestrian", colorOfKind(ObjectKind::kPedestrian)},
       {"bush", kLeafColor},
       {"wall", kWallColor}}};
  double x = at.x();
  for (const auto& [name, color] : entries) {
    canvas.rectangle({x, at.y() - 9, 14, 9}, color);
    canvas.text({x + 18, at.y()}, name, 10, kInk);
    x += 34 + Canvas::textWidth(name, 10);
  }
  canvas.text({at.x(), at.y() + 16},
              "filled: at half time; pale: at the start; arrow: end of the way; black dots: poles",
              10, kMutedInk);
}

}  // namespace

Picture scenarioSheet(const std::vector<NamedScenario>& scenarios) {
  const int count = std::max(1, static_cast<int>(scenarios.size()));
  const int columns = count <= 2 ? count : count <= 4 ? 2 : 3;
  const int rows = (count + columns - 1) / columns;
  constexpr int kWidth = 520, kHeight = 400, kGap = 14, kTop = 40, kBottom = 44;
  const int width = std::max(1000, columns * (kWidth + kGap) + kGap);
  Canvas canvas(width, kTop + rows * (kHeight + kGap) + kBottom);
  canvas.text({kGap, 24}, "Scenarios of the simulator, seen from above", 15, kInk, true);
  for (int i = 0; i < static_cast<int>(scenarios.size()); ++i) {
    const Rect area{static_cast<double>(kGap + i % columns * (kWidth + kGap)),
                    static_cast<double>(kTop + i / columns * (kHeight + kGap)), kWidth, kHeight};
    drawScenario(canvas, area, scenarios[static_cast<std::size_t>(i)]);
  }
  drawLegend(canvas, {kGap, static_cast<double>(kTop + rows * (kHeight + kGap) + 12)});
  return canvas.picture();
}

}  // namespace perception
