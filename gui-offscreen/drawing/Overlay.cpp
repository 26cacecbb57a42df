#include "gui-offscreen/drawing/Overlay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gui-offscreen/drawing/LabelLayout.h"
#include "gui-offscreen/drawing/PictureStyle.h"
#include "gui-offscreen/drawing/ViewPen.h"

namespace perception {
namespace {

constexpr double kReach = 90, kMutedReach = 4;  // [px] from an object to its label
constexpr double kLabelSize = 8.5;              // [px] height of capitals
constexpr double kImageReach = 1.5;  // of the range: farther objects are not drawn on images

/// Draws what is given in the ego frame.
class Overlay {
 public:
  Overlay(Canvas& canvas, const SceneView& view, const ViewCamera& camera, const Rect& at)
      : canvas_(canvas),
        view_(view),
        camera_(camera),
        at_(at),
        pen_(canvas, camera, at),
        T_ego_world_(view.scene.ego.T_world_ego.inverse()),
        ego_yaw_(yawOf(view.scene.ego.T_world_ego)) {}

  int draw() {
    canvas_.clip(at_);
    if (camera_.kind == ViewKind::kCamera) return drawOnImage();
    taken_ = drawSurroundings(pen_, view_);
    for (const ViewRadarReturn& point : view_.radar) drawRadar(point);
    for (const SceneObject& object : view_.scene.objects) drawTrail(object);
    for (const SceneObject& object : view_.scene.objects) drawOutline(object);
    for (const ViewMeasurement& measurement : view_.measurements) drawMeasurement(measurement);
    for (const TruthObject& object : view_.truth) drawTruth(object);
    for (const SceneObject& object : view_.scene.objects) drawArrow(object);
    const int left_out = drawLabels();
    canvas_.unclip();
    return left_out;
  }

 private:
  std::optional<Vector2> pixel(const Vector3& p) const { return pen_.pixel(p); }

  std::array<Vector3, 8> cornersOf(const SceneObject& o) const {
    return boxCorners(T_ego_world_ * o.position, o.yaw - ego_yaw_, o.length, o.width, o.height);
  }

  void drawTruth(const TruthObject& o) {
    const auto corners =
        boxCorners(T_ego_world_ * o.position, o.yaw - ego_yaw_, o.length, o.width, o.height);
    pen_.box(corners, kPaper, 3, false);  // a white border, for contrast on outlines
    pen_.box(corners, kInk, 1.2, false);
  }

  int drawOnImage();
  void drawImagePoints();
  void drawDetectorBoxes();
  void drawRadar(const ViewRadarReturn& point);
  void drawMeasurement(const ViewMeasurement& measurement);
  bool inFront(const Vector3& world) const {
    return camera_.project(T_ego_world_ * world).has_value();
  }
  double distanceOf(const SceneObject& object) const {
    return (T_ego_world_ * object.position).norm();
  }

  void drawTrail(const SceneObject& object) {
    const auto trail = view_.trails.find(object.id);
    if (trail == view_.trails.end()) return;
    const Color color = colorOfClass(view_.className(object), object.class_id);
    const auto& places = trail->second;
    for (std::size_t i = 1; i < places.size(); ++i) {
      pen_.line(T_ego_world_ * places[i - 1], T_ego_world_ * places[i], color, 1.5);
    }
  }

  void drawOutline(const SceneObject& object) {
    const Color color = colorOfClass(view_.className(object), object.class_id);
    const auto corners = cornersOf(object);
    const bool muted = isMuted(view_.className(object));
    pen_.box(corners, color, muted ? 1.2 : 2, object.existence < kSureExistence);
    // A bar marks the front where it is known.
    if (!muted && object.has_yaw && object.p_front >= kSureFront) {
      const auto inward = [&](std::size_t front, std::size_t rear) -> Vector3 {
        return corners[front] + 0.2 * (corners[rear] - corners[front]);
      };
      pen_.line(inward(4, 7), inward(5, 6), color, 2);
    }
  }

  void drawArrow(const SceneObject& object) {
    const double speed = object.velocity.norm();
    if (speed < kStanding) return;
    const double z = camera_.kind == ViewKind::kTop ? 0 : object.height / 2;
    const Vector3 from = T_ego_world_ * (object.position + Vector3(0, 0, z));
    const Vector2 way = rotate2(-ego_yaw_, object.velocity) * kArrowTime;
    const auto a = pixel(from), b = pixel(from + Vector3(way.x(), way.y(), 0));
    if (!a || !b) return;
    canvas_.arrow(*a, *b, colorOfClass(view_.className(object), object.class_id), 2);
  }

  int drawLabels();
  std::string labelOf(const SceneObject& object) const;
  std::optional<Rect> frameOf(const SceneObject& object) const;

  Canvas& canvas_;
  const SceneView& view_;
  const ViewCamera& camera_;
  Rect at_;
  ViewPen pen_;
  Pose3 T_ego_world_;
  double ego_yaw_;
  std::vector<Rect> taken_;  // by text that is there already
};

// A camera of the vehicle: its image or, if the log has none, the lidar returns; boxes from far to
// near.
int Overlay::drawOnImage() {
  if (view_.image->picture.width == 0) drawImagePoints();
  std::vector<const SceneObject*> objects;
  for (const SceneObject& object : view_.scene.objects) {
    if (inFront(object.position) && distanceOf(object) <= kImageReach * camera_.range) {
      objects.push_back(&object);
    }
  }
  std::stable_sort(objects.begin(), objects.end(),
                   [&](const auto* a, const auto* b) { return distanceOf(*a) > distanceOf(*b); });
  for (const TruthObject& object : view_.truth) {
    if (inFront(object.position)) drawTruth(object);
  }
  drawDetectorBoxes();
  for (const SceneObject* object : objects) drawOutline(*object);
  const int left_out = drawLabels();
  canvas_.unclip();
  return left_out;
}

void Overlay::drawImagePoints() {
  for (const ViewPoint& point : view_.points) {
    const auto at = pixel(T_ego_world_ * point.place);
    if (!at || !at_.overlaps({at->x(), at->y(), 1, 1})) continue;
    const bool ground = point.height < kHeightLow;
    const Color c = point.trust < kTrusted ? kPhantom
                    : ground               ? kGroundPoint
                                           : colorOfHeight(point.height);
    canvas_.disc(*at, ground ? 0.5 : 1, c);
  }
}

void Overlay::drawDetectorBoxes() {
  const double scale = camera_.focal / view_.image->camera.fx;
  for (const ViewImage::Box& found : view_.image->boxes) {
    const auto& b = found.box;
    const Vector2 corner(at_.x, at_.y);
    const Vector2 c[] = {{b.x1, b.y1}, {b.x2, b.y1}, {b.x2, b.y2}, {b.x1, b.y2}};
    for (int i = 0; i < 4; ++i) {
      canvas_.dashedLine(corner + scale * c[i], corner + scale * c[(i + 1) % 4], kDetectorBox, 1.5,
                         ViewPen::kDash);
    }
  }
}

void Overlay::drawRadar(const ViewRadarReturn& point) {
  const Vector3 place = T_ego_world_ * point.place;
  const auto at = pixel(place);
  if (!at) return;
  canvas_.disc(*at, 3.2, kPaper);
  canvas_.disc(*at, 2.4, kRadarReturn);
  if (!point.has_rate || point.radial_velocity.norm() < kStanding) return;
  const Vector2 way = rotate2(-ego_yaw_, point.radial_velocity) * kArrowTime;
  const auto tip = pixel(place + Vector3(way.x(), way.y(), 0));
  if (tip) canvas_.arrow(*at, *tip, kRadarReturn, 1.5);
}

void Overlay::drawMeasurement(const ViewMeasurement& measurement) {
  const auto& outline = measurement.outline;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    pen_.line(T_ego_world_ * outline[i], T_ego_world_ * outline[(i + 1) % outline.size()],
              kMeasurement, 1.2);
  }
  const auto at = pixel(T_ego_world_ * measurement.place);
  if (at) drawMeasurementMark(canvas_, *at, measurement.modality);
}

std::string Overlay::labelOf(const SceneObject& object) const {
  std::string name = view_.className(object);
  if (isMuted(name)) return fmt::format("{}", object.id);
  const auto c = static_cast<std::size_t>(object.class_id);
  const double p = c < object.class_probability.size() ? object.class_probability[c] : 0;
  std::replace(name.begin(), name.end(), '_', ' ');
  std::string text =
      fmt::format("{} {}{} {:.2f}", object.id, name, object.classified ? "" : "?", p);
  const double speed = object.velocity.norm();
  if (speed >= kStanding) text += fmt::format(", {:.0f} km/h", speed * 3.6);
  return text;
}

// Bounding rectangle of the object's box in the picture; empty if not visible.
std::optional<Rect> Overlay::frameOf(const SceneObject& object) const {
  double low_x = 1e9, low_y = 1e9, high_x = -1e9, high_y = -1e9;
  for (const Vector3& corner : cornersOf(object)) {
    const auto p = pixel(corner);
    if (!p) return std::nullopt;
    low_x = std::min(low_x, p->x());
    high_x = std::max(high_x, p->x());
    low_y = std::min(low_y, p->y());
    high_y = std::max(high_y, p->y());
  }
  const Rect frame{low_x, low_y, high_x - low_x, high_y - low_y};
  if (!at_.overlaps(frame)) return std::nullopt;
  // Across the seam of a panorama.
  if (camera_.kind == ViewKind::kCamera && frame.width > at_.width / 2) return std::nullopt;
  return frame;
}

int Overlay::drawLabels() {
  struct Label {
    const SceneObject* object;
    std::string text;
    double size;
  };
  std::vector<Label> labels;
  std::vector<LabelWish> wishes;
  for (const SceneObject& object : view_.scene.objects) {
    const auto frame = frameOf(object);
    const double distance = (T_ego_world_ * object.position).norm();
    if (!frame || (camera_.kind != ViewKind::kTop && distance > kImageReach * camera_.range)) {
      continue;
    }
    const bool muted = isMuted(view_.className(object));
    if (muted && !view_.layers.thing_ids) continue;
    labels.push_back({&object, labelOf(object), muted ? kSmallSize - 0.5 : kLabelSize});
    const Label& label = labels.back();
    wishes.push_back({*frame, Canvas::textWidth(label.text, label.size, !muted) + 6, label.size + 6,
                      (muted ? 100000 : 0) + static_cast<int>(distance * 10),
                      muted ? kMutedReach : kReach});
  }
  const auto places = placeLabels(wishes, taken_, at_);
  int left_out = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (!places[i]) {
      ++left_out;
      continue;
    }
    const Rect& r = *places[i];
    const bool muted = isMuted(view_.className(*labels[i].object));
    const Color color =
        colorOfClass(view_.className(*labels[i].object), labels[i].object->class_id);
    const Rect& o = wishes[i].object;
    // A line from the label to the object if they are apart.
    const Vector2 from(std::clamp(o.x + o.width / 2, r.x, r.right()),
                       std::clamp(o.y + o.height / 2, r.y, r.bottom()));
    const Vector2 to(std::clamp(from.x(), o.x, o.right()), std::clamp(from.y(), o.y, o.bottom()));
    if ((to - from).norm() > 6) canvas_.line(from, to, color, 1);
    canvas_.rectangle(r, kPaper.withAlpha(muted ? 0.7 : 0.88));
    canvas_.text({r.x + 3, r.bottom() - 3}, labels[i].text, labels[i].size, color, !muted);
  }
  return left_out;
}

}  // namespace

void drawMeasurementMark(Canvas& canvas, const Vector2& at, Modality modality) {
  constexpr double kSize = 4;  // [px] half
  const auto corner = [&](double angle) -> Vector2 {
    return at + kSize * Vector2(std::sin(angle), -std::cos(angle));
  };
  const int corners = rowOf(modality).mark_corners;
  for (int i = 0; i < corners; ++i) {
    canvas.line(corner(kTwoPi * i / corners), corner(kTwoPi * (i + 1) / corners), kMeasurement,
                1.5);
  }
}

int drawOverlay(Canvas& canvas, const SceneView& view, const ViewCamera& camera, const Rect& at) {
  return Overlay(canvas, view, camera, at).draw();
}

}  // namespace perception
