#include "gui-offscreen/views/SceneFile.h"

#include <fmt/format.h>
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/opengl/CArrow.h>
#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/opengl/CSetOfLines.h>
#include <mrpt/opengl/CText3D.h>
#include <mrpt/serialization/CArchive.h>

#include "gui-offscreen/drawing/Palette.h"
#include "gui-offscreen/drawing/PictureStyle.h"
#include "libperception/scene/files/OutputFile.h"

namespace perception {
namespace {

constexpr float kLetter = 0.5F;     // [m] height of letters
constexpr double kLetterGap = 0.3;  // [m] between an object's roof and its label

mrpt::img::TColor opaqueColorOf(const Color& c) { return {c.r, c.g, c.b, 255}; }

mrpt::math::TPoint3D doublePointOf(const Vector3& p) { return {p.x(), p.y(), p.z()}; }

void addLabel(mrpt::opengl::COpenGLScene& scene, const SceneObject& object, const std::string& name,
              const Vector3& place, const Color& color) {
  std::string text =
      isMuted(name) ? fmt::format("{}", object.id) : fmt::format("{} {}", object.id, name);
  const double speed = object.velocity.norm();
  if (!isMuted(name) && speed >= kStanding) text += fmt::format(" {:.0f} km/h", speed * 3.6);
  auto label = mrpt::opengl::CText3D::Create(text, "sans", kLetter);
  label->setName(fmt::format("label {}", object.id));
  label->setColor_u8(opaqueColorOf(color));
  // Upright, facing a viewer behind the vehicle.
  label->setPose(mrpt::poses::CPose3D(place.x(), place.y(), place.z() + object.height + kLetterGap,
                                      -kPi / 2, 0, kPi / 2));
  scene.insert(label);
}

void addMotion(mrpt::opengl::COpenGLScene& scene, const SceneView& view, const SceneObject& object,
               const Pose3& T_ego_world, const Color& color) {
  if (object.velocity.norm() >= kStanding) {
    const Vector3 from = object.position + Vector3(0, 0, object.height / 2);
    const Vector3 a = T_ego_world * from;
    const Vector3 b =
        T_ego_world * (from + Vector3(object.velocity.x(), object.velocity.y(), 0) * kArrowTime);
    auto arrow = mrpt::opengl::CArrow::Create(static_cast<float>(a.x()), static_cast<float>(a.y()),
                                              static_cast<float>(a.z()), static_cast<float>(b.x()),
                                              static_cast<float>(b.y()), static_cast<float>(b.z()),
                                              0.25F, 0.06F, 0.18F);
    arrow->setName(fmt::format("velocity {}", object.id));
    arrow->setColor_u8(opaqueColorOf(color));
    scene.insert(arrow);
  }
  const auto trail = view.trails.find(object.id);
  if (trail == view.trails.end() || trail->second.size() < 2) return;
  auto path = mrpt::opengl::CSetOfLines::Create();
  path->setName(fmt::format("path {}", object.id));
  path->setColor_u8(opaqueColorOf(color));
  for (std::size_t i = 1; i < trail->second.size(); ++i) {
    path->appendLine(doublePointOf(T_ego_world * trail->second[i - 1]),
                     doublePointOf(T_ego_world * trail->second[i]));
  }
  scene.insert(path);
}

void addBoxLines(mrpt::opengl::CSetOfLines& lines, const std::array<Vector3, 8>& corners,
                 const Pose3& T_ego_world) {
  for (std::size_t i = 0; i < 4; ++i) {
    for (const auto& [a, b] : {std::make_pair(i, (i + 1) % 4),
                               std::make_pair(i + 4, (i + 1) % 4 + 4), std::make_pair(i, i + 4)}) {
      lines.appendLine(doublePointOf(T_ego_world * corners[a]),
                       doublePointOf(T_ego_world * corners[b]));
    }
  }
}

void addTruthAndMeasurements(mrpt::opengl::COpenGLScene& scene, const SceneView& view,
                             const Pose3& T_ego_world) {
  auto truth = mrpt::opengl::CSetOfLines::Create();
  truth->setName("truth");
  truth->setColor_u8(opaqueColorOf(kInk));
  for (const TruthObject& o : view.truth) {
    addBoxLines(*truth, boxCorners(o.position, o.yaw, o.length, o.width, o.height), T_ego_world);
  }
  scene.insert(truth);
  auto outlines = mrpt::opengl::CSetOfLines::Create();
  outlines->setName("measurements");
  outlines->setColor_u8(opaqueColorOf(kMeasurement));
  for (const ViewMeasurement& m : view.measurements) {
    for (std::size_t i = 0; i < m.outline.size(); ++i) {
      outlines->appendLine(doublePointOf(T_ego_world * m.outline[i]),
                           doublePointOf(T_ego_world * m.outline[(i + 1) % m.outline.size()]));
    }
  }
  scene.insert(outlines);
}

}  // namespace

void writeSceneFile(const std::string& path, const SceneView& view, double range,
                    const std::string& mark) {
  ViewCamera ground;
  ground.range = range;
  const auto scene = openGlScene(view, ground);
  const Pose3 T_ego_world = view.scene.ego.T_world_ego.inverse();
  for (const SceneObject& object : view.scene.objects) {
    const std::string& name = view.className(object);
    const Color color = colorOfClass(name, object.class_id);
    addLabel(*scene, object, name, T_ego_world * object.position, color);
    addMotion(*scene, view, object, T_ego_world, color);
  }
  addTruthAndMeasurements(*scene, view, T_ego_world);
  if (!mark.empty()) {
    auto nothing = mrpt::opengl::CSetOfLines::Create();
    nothing->setName(mark);
    scene->insert(nothing);
  }
  const auto viewport = scene->getViewport();
  viewport->setCustomBackgroundColor({1.0F, 1.0F, 1.0F});
  auto& camera = viewport->getCamera();
  camera.setPointingAt(static_cast<float>(range / 3), 0, 0);
  camera.setZoomDistance(static_cast<float>(range));
  camera.setAzimuthDegrees(180);
  camera.setElevationDegrees(35);
  // In memory first, since MRPT's saving does not report a full disk.
  mrpt::io::CMemoryStream bytes;
  mrpt::serialization::archiveFrom(bytes) << *scene;
  writeFile(path, {static_cast<const char*>(bytes.getRawBufferData()),
                   static_cast<std::size_t>(bytes.getTotalBytesCount())});
}

}  // namespace perception
