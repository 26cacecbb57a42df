#include "gui-offscreen/views/SceneView.h"

#include <mrpt/opengl/CBox.h>
#include <mrpt/opengl/CPointCloudColoured.h>
#include <mrpt/opengl/CSetOfLines.h>
#include <mrpt/opengl/CSetOfTriangles.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "gui-offscreen/drawing/Palette.h"

namespace perception {
namespace {

using mrpt::math::TPoint3Df;

constexpr double kGridStep = 10;      // [m] between the lines on the ground
constexpr float kGridLevel = -0.05F;  // [m] below the ground's returns
// [px] of the framebuffer, which has twice the picture's resolution.
constexpr float kGroundPointSize = 2, kObstaclePointSize = 4;
constexpr float kGroundHeight = 0.3F;  // [m] above which a return is an obstacle (method.md 8.1)

std::uint8_t alphaByte(double alpha) { return static_cast<std::uint8_t>(std::lround(255 * alpha)); }

mrpt::img::TColor colorOf(const Color& c) { return {c.r, c.g, c.b, alphaByte(c.alpha)}; }

TPoint3Df pointOf(const Vector3& p) {
  return {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
}

void addGrid(mrpt::opengl::COpenGLScene& scene, double range) {
  auto lines = mrpt::opengl::CSetOfLines::Create();
  lines->setColor_u8(colorOf(kGridLine));
  const double reach = std::ceil(3 * range / kGridStep) * kGridStep;
  for (double at = -reach; at <= reach; at += kGridStep) {
    lines->appendLine(-reach, at, kGridLevel, reach, at, kGridLevel);
    lines->appendLine(at, -reach, kGridLevel, at, reach, kGridLevel);
  }
  scene.insert(lines);
}

void addPoints(mrpt::opengl::COpenGLScene& scene, const SceneView& view, const Pose3& T_ego_world) {
  auto ground = mrpt::opengl::CPointCloudColoured::Create();
  auto obstacles = mrpt::opengl::CPointCloudColoured::Create();
  for (const ViewPoint& point : view.points) {
    const bool low = point.height < kGroundHeight;
    const Color c = point.trust < kTrusted ? kPhantom
                    : low                  ? kGroundPoint
                                           : colorOfHeight(point.height);
    const TPoint3Df p = pointOf(T_ego_world * point.place);
    (low ? ground : obstacles)
        ->push_back(p.x, p.y, p.z, static_cast<float>(c.r) / 255, static_cast<float>(c.g) / 255,
                    static_cast<float>(c.b) / 255);
  }
  ground->setPointSize(kGroundPointSize);
  obstacles->setPointSize(kObstaclePointSize);
  for (const auto& cloud : {ground, obstacles}) {
    cloud->enableVariablePointSize(false);
    scene.insert(cloud);
  }
}

// Cells above each other are drawn as one column.
struct Column {
  double x = 0, y = 0, size = 0, low = 0, high = 0;  // [m] world
};

std::vector<Column> columnsOf(const std::vector<GridCell>& cells) {
  std::map<std::pair<std::int64_t, std::int64_t>, Column> columns;
  for (const GridCell& cell : cells) {
    const double size = cell.size.x();
    const auto key = std::make_pair(std::llround(cell.center.x() / size * 2),
                                    std::llround(cell.center.y() / size * 2));
    const double low = cell.center.z() - cell.size.z() / 2;
    const double high = cell.center.z() + cell.size.z() / 2;
    const auto [at, fresh] =
        columns.try_emplace(key, Column{cell.center.x(), cell.center.y(), size, low, high});
    at->second.low = std::min(at->second.low, low);
    at->second.high = std::max(at->second.high, high);
  }
  std::vector<Column> list;
  for (const auto& [key, column] : columns) list.push_back(column);
  return list;
}

void addQuad(mrpt::opengl::CSetOfTriangles& triangles, const std::array<Vector3, 4>& corners,
             const Color& color) {
  for (const auto& [b, c] : {std::make_pair(1, 2), std::make_pair(2, 3)}) {
    mrpt::opengl::TTriangle t;
    t.vertex(0) = pointOf(corners[0]);
    t.vertex(1) = pointOf(corners[static_cast<std::size_t>(b)]);
    t.vertex(2) = pointOf(corners[static_cast<std::size_t>(c)]);
    t.setColor(colorOf(color));
    t.computeNormals();
    triangles.insertTriangle(t);
  }
}

// In the top view flat squares below the returns; in the driver view low boxes that occlude
// nothing.
void addOccupied(mrpt::opengl::COpenGLScene& scene, const SceneView& view,
                 const Pose3& T_ego_world) {
  constexpr double kLevel = 0.02;  // [m] above the grid's lines
  constexpr double kRim = 1.5;     // factor on the cell size: returns would cover the cell
  auto triangles = mrpt::opengl::CSetOfTriangles::Create();
  for (const Column& column : columnsOf(view.occupied)) {
    const double h = kRim * column.size / 2;
    std::array<Vector3, 4> square = {
        Vector3(column.x - h, column.y - h, 0), Vector3(column.x + h, column.y - h, 0),
        Vector3(column.x + h, column.y + h, 0), Vector3(column.x - h, column.y + h, 0)};
    const double z = view.scene.ego.T_world_ego.translation().z();
    for (Vector3& corner : square) {
      corner.z() = z;
      corner = T_ego_world * corner;
      corner.z() = kLevel;
    }
    addQuad(*triangles, square, kOccupied);
  }
  scene.insert(triangles);
}

mrpt::opengl::CBox::Ptr solidBox(double length, double width, double height, const Color& color) {
  auto box = mrpt::opengl::CBox::Create(mrpt::math::TPoint3D(-length / 2, -width / 2, 0),
                                        mrpt::math::TPoint3D(length / 2, width / 2, height));
  box->setColor_u8(colorOf(color));
  return box;
}

void addObjects(mrpt::opengl::COpenGLScene& scene, const SceneView& view,
                const Pose3& T_ego_world) {
  constexpr double kMostOpaque = 0.45;
  for (const SceneObject& object : view.scene.objects) {
    const Color color = colorOfClass(view.className(object), object.class_id)
                            .withAlpha(kMostOpaque * object.existence * object.existence);
    auto box = solidBox(object.length, object.width, object.height, color);
    const Vector3 place = T_ego_world * object.position;
    box->setPose(mrpt::poses::CPose3D(place.x(), place.y(), place.z(),
                                      object.yaw + yawOf(T_ego_world), 0, 0));
    scene.insert(box);
  }
}

void addVehicle(mrpt::opengl::COpenGLScene& scene) {
  auto body = solidBox(4.4, 1.8, 0.9, kEgo.withAlpha(0.85));
  body->setLocation(kEgoMiddle, 0, 0.2);
  scene.insert(body);
  auto cabin = solidBox(2.2, 1.6, 0.5, kEgo.withAlpha(0.85));
  cabin->setLocation(kEgoMiddle - 0.4, 0, 1.1);
  scene.insert(cabin);
}

}  // namespace

const std::string& SceneView::className(const SceneObject& object) const {
  static const std::string unknown = "?";
  const auto i = static_cast<std::size_t>(object.class_id);
  return object.class_id >= 0 && i < class_names.size() ? class_names[i] : unknown;
}

std::map<std::uint64_t, std::vector<Vector3>> trailsUpTo(const std::vector<Scene>& scenes,
                                                         std::size_t index, double seconds) {
  std::map<std::uint64_t, std::vector<Vector3>> trails;
  if (index >= scenes.size()) return trails;
  std::size_t first = index;
  while (first > 0 && scenes[index].stamp - scenes[first - 1].stamp <= seconds) --first;
  for (const SceneObject& now : scenes[index].objects) trails[now.id];
  for (std::size_t i = first; i <= index; ++i) {
    for (const SceneObject& object : scenes[i].objects) {
      const auto trail = trails.find(object.id);
      if (trail != trails.end()) trail->second.push_back(object.position);
    }
  }
  return trails;
}

std::array<Vector3, 8> boxCorners(const Vector3& bottom_center, double yaw, double length,
                                  double width, double height) {
  std::array<Vector3, 8> corners;
  constexpr int kForward[] = {1, 1, -1, -1}, kLeft[] = {1, -1, -1, 1};
  for (std::size_t i = 0; i < 8; ++i) {
    const Vector2 flat = rotate2(yaw, {kForward[i % 4] * length / 2, kLeft[i % 4] * width / 2});
    corners[i] = bottom_center + Vector3(flat.x(), flat.y(), i < 4 ? 0 : height);
  }
  return corners;
}

std::shared_ptr<mrpt::opengl::COpenGLScene> openGlScene(const SceneView& view,
                                                        const ViewCamera& camera) {
  auto scene = mrpt::opengl::COpenGLScene::Create();
  const Pose3 T_ego_world = view.scene.ego.T_world_ego.inverse();
  addGrid(*scene, camera.range);
  addOccupied(*scene, view, T_ego_world);
  addPoints(*scene, view, T_ego_world);
  addVehicle(*scene);
  addObjects(*scene, view, T_ego_world);
  return scene;
}

}  // namespace perception
