#include "libperception/pictures/ReviewPictures.h"

#include <algorithm>
#include <array>
#include <utility>

#include "gui-offscreen/drawing/Canvas.h"
#include "libperception/pictures/RunScenes.h"
#include "libperception/pipeline/output/Progress.h"

namespace perception {
namespace {

constexpr int kSupersampling = 2;   // framebuffer pixels per pixel
constexpr double kAcross = 24;      // [m] of the view from above
constexpr double kShownAround = 2;  // of the object's size, in the other two
constexpr double kRoof = 2.5;       // [m] height of the eye above the ground
constexpr double kClear = 1.5;      // [m] before the object is free of the own vehicle
constexpr Color kOutline{0, 90, 200};
constexpr int kEdges[12][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6},
                               {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};

std::array<Vector3, 8> cornersInEgo(const SceneView& view, const SceneObject& object) {
  auto corners =
      boxCorners(object.position, object.yaw, object.length, object.width, object.height);
  const Pose3 T_ego_world = view.scene.ego.T_world_ego.inverse();
  for (Vector3& corner : corners) corner = T_ego_world * corner;
  return corners;
}

Vector3 middleOf(const std::array<Vector3, 8>& corners) {
  Vector3 sum = Vector3::Zero();
  for (const Vector3& corner : corners) sum += corner;
  return sum / 8;
}

double sizeOf(const SceneObject& object) {
  return std::max({Vector2(object.length, object.width).norm(), object.height, 1.0});
}

void drawBox(Canvas& canvas, const std::array<Vector3, 8>& corners, const ViewCamera& camera,
             const Vector2& offset, double scale) {
  for (const auto& edge : kEdges) {
    for (const auto& [a, b] : camera.projectLine(corners[static_cast<std::size_t>(edge[0])],
                                                 corners[static_cast<std::size_t>(edge[1])])) {
      canvas.line((a - offset) * scale, (b - offset) * scale, kOutline, 1.5);
    }
  }
}

/// A camera at `eye` that looks at `target`, `across` meters wide there; ego frame.
ViewCamera lookingAt(const Vector3& eye, const Vector3& target, double across) {
  ViewCamera camera{ViewKind::kDriver, ReviewPictures::kWidth, ReviewPictures::kHeight};
  const Vector3 ahead = target - eye;
  const double distance = std::max(1.0, ahead.norm());
  camera.focal = camera.focal_y = camera.width / across * distance;
  camera.center = Vector2(camera.width / 2.0, camera.height / 2.0);
  const Vector3 z = ahead.normalized();
  const Vector3 x = z.cross(Vector3::UnitZ()).normalized();
  camera.T_ego_camera.linear().col(0) = x;
  camera.T_ego_camera.linear().col(1) = z.cross(x);
  camera.T_ego_camera.linear().col(2) = z;
  camera.T_ego_camera.translation() = eye;
  camera.near = std::max(0.5, distance - across / 2 - kClear);
  camera.far = distance + 60;
  camera.range = distance + 20;
  return camera;
}

/// Rectangle around points, widened about its center.
Rect around(const std::vector<Vector2>& points, double widen) {
  Vector2 low = points.front(), high = points.front();
  for (const Vector2& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Vector2 middle = (low + high) / 2, half = (high - low) / 2 * widen;
  return {middle.x() - half.x(), middle.y() - half.y(), 2 * half.x(), 2 * half.y()};
}

Picture cut(const Picture& from, int x, int y, int width, int height) {
  Picture part{width, height, {}};
  part.rgb.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3);
  for (int row = y; row < y + height; ++row)
    part.rgb.insert(part.rgb.end(), from.at(x, row), from.at(x, row) + 3 * width);
  return part;
}

}  // namespace

ReviewPictures::ReviewPictures() : renderer_(kWidth * kSupersampling, kHeight * kSupersampling) {}

Picture ReviewPictures::draw(const SceneView& view, const SceneObject& object,
                             const ViewCamera& camera) {
  SceneView bare = view;
  bare.scene.objects.clear();
  bare.trails.clear();
  bare.measurements.clear();
  bare.occupied.clear();
  bare.corridor.reset();
  Canvas canvas(kWidth, kHeight);
  canvas.paste(renderer_.render(bare, camera), canvas.area());
  drawBox(canvas, cornersInEgo(view, object), camera, Vector2::Zero(), 1);
  return canvas.picture();
}

Picture ReviewPictures::fromAbove(const SceneView& view, std::size_t index) {
  const SceneObject& object = view.scene.objects.at(index);
  const Vector3 middle = middleOf(cornersInEgo(view, object));
  ViewCamera camera = ViewCamera::top(kAcross, kWidth, kHeight);
  camera.focal = camera.focal_y = kWidth / kAcross * camera.T_ego_camera.translation().z();
  camera.T_ego_camera.translation().head<2>() = middle.head<2>();
  camera.range = middle.head<2>().norm() + kAcross;
  return draw(view, object, camera);
}

Picture ReviewPictures::fromVehicle(const SceneView& view, std::size_t index) {
  const SceneObject& object = view.scene.objects.at(index);
  const Vector3 middle = middleOf(cornersInEgo(view, object));
  return draw(view, object, lookingAt({0, 0, kRoof}, middle, kShownAround * sizeOf(object)));
}

std::optional<Picture> ReviewPictures::fromCamera(const SceneView& view, std::size_t index) const {
  if (!view.image || view.image->picture.width == 0) return std::nullopt;
  const ViewImage& image = *view.image;
  const double scale = static_cast<double>(image.picture.width) / image.camera.width;
  const ViewCamera camera = ViewCamera::image(
      image.camera, view.scene.ego.T_world_ego.inverse() * image.T_world_camera, scale);
  const auto corners = cornersInEgo(view, view.scene.objects.at(index));
  std::vector<Vector2> points;
  for (const Vector3& corner : corners) {
    if (const auto p = camera.project(corner)) points.push_back(*p);
  }
  if (points.size() < corners.size()) return std::nullopt;
  const Rect wanted = around(points, kShownAround);
  const int left = std::clamp(static_cast<int>(wanted.x), 0, image.picture.width);
  const int top = std::clamp(static_cast<int>(wanted.y), 0, image.picture.height);
  const int right = std::clamp(static_cast<int>(wanted.right()), 0, image.picture.width);
  const int bottom = std::clamp(static_cast<int>(wanted.bottom()), 0, image.picture.height);
  if (right - left < 8 || bottom - top < 8) return std::nullopt;
  const double zoom = std::min(static_cast<double>(kWidth) / (right - left),
                               static_cast<double>(kHeight) / (bottom - top));
  const int width = std::max(1, static_cast<int>((right - left) * zoom));
  const int height = std::max(1, static_cast<int>((bottom - top) * zoom));
  Canvas canvas(width, height);
  canvas.paste(cut(image.picture, left, top, right - left, bottom - top), canvas.area());
  drawBox(canvas, corners, camera, Vector2(left, top), zoom);
  return canvas.picture();
}

std::vector<ReviewQuestion> reviewQuestions(const TrackedRun& run, const std::string& run_id,
                                            const std::vector<ReviewItem>& items,
                                            SnapshotSensors& sensors) {
  ReviewPictures pictures;
  std::vector<ReviewQuestion> questions;
  Progress progress("drawing", items.size());
  for (const ReviewItem& item : items) {
    stopIfAsked();
    SceneView view = viewOfScene(run, item.scene, nullptr);
    sensors.advanceTo(view.scene.stamp);
    sensors.fill(view);
    // The line of the item without its answer.
    std::string row = reviewText(run_id, {item});
    row = row.substr(row.find('\n') + 1);
    row.erase(row.rfind(','));
    ReviewQuestion q{item.t, std::to_string(item.id), item.class_name, std::move(row), {}};
    if (auto image = pictures.fromCamera(view, item.object))
      q.pictures.push_back(std::move(*image));
    q.pictures.push_back(pictures.fromVehicle(view, item.object));
    q.pictures.push_back(pictures.fromAbove(view, item.object));
    questions.push_back(std::move(q));
    progress.update(questions.size(), questions.size());
  }
  return questions;
}

}  // namespace perception
