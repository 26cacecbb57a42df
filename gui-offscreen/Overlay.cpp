#include "gui-offscreen/Overlay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gui-offscreen/LabelLayout.h"

namespace perception {
namespace {

constexpr double kReach = 90, kMutedReach = 4;  // [px] from an object to its label
constexpr double kAxisStep = 10;                // [m]
constexpr double kLabelSize = 8.5;              // [px] height of capitals
constexpr double kSmallSize = 7.5;              // [px]
constexpr double kArrowTime = 1;                // [s] the speed arrow shows the way of so long
constexpr double kStanding = 0.5;               // [m/s] below it there is no arrow
constexpr double kDash = 4;                     // [px]
constexpr double kImageReach = 1.5;  // of the range: farther objects crowd at the horizon

/// Draws what is given in the ego frame.
class Overlay {
 public:
  Overlay(Canvas& canvas, const SceneView& view, const ViewCamera& camera, const Rect& at)
      : canvas_(canvas),
        view_(view),
        camera_(camera),
        at_(at),
        T_ego_world_(view.scene.ego.T_world_ego.inverse()),
        ego_yaw_(yawOf(view.scene.ego.T_world_ego)) {}

  int draw() {
    canvas_.clip(at_);
    if (camera_.kind == ViewKind::kCamera) return drawOnImage();
    drawAxes();
    drawFreeDistance();
    drawVehicle();
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
  std::optional<Vector2> pixel(const Vector3& p) const {
    const auto px = camera_.project(p);
    if (!px) return std::nullopt;
    return Vector2(px->x() + at_.x, px->y() + at_.y);
  }

  void line(const Vector3& a, const Vector3& b, const Color& color, double thickness,
            bool dashed = false) {
    const Vector2 corner(at_.x, at_.y);
    for (const auto& [from, to] : camera_.projectLine(a, b)) {
      if (dashed) {
        canvas_.dashedLine(from + corner, to + corner, color, thickness, kDash);
      } else {
        canvas_.line(from + corner, to + corner, color, thickness);
      }
    }
  }

  void box(const std::array<Vector3, 8>& c, const Color& color, double thickness, bool dashed) {
    const bool flat = camera_.kind == ViewKind::kTop;  // roof and floor coincide
    for (std::size_t i = 0; i < 4; ++i) {
      const std::size_t next = (i + 1) % 4;
      line(c[i], c[next], color, thickness, dashed);
      if (flat) continue;
      line(c[i + 4], c[next + 4], color, thickness, dashed);
      line(c[i], c[i + 4], color, thickness, dashed);
    }
  }

  std::array<Vector3, 8> cornersOf(const SceneObject& o) const {
    return boxCorners(T_ego_world_ * o.position, o.yaw - ego_yaw_, o.length, o.width, o.height);
  }

  void drawAxes();
  void axisText(const Vector3& place, const std::string& text);
  void drawScale();
  void drawFreeDistance();
  void drawVehicle();

  void drawTruth(const TruthObject& o) {
    const auto corners =
        boxCorners(T_ego_world_ * o.position, o.yaw - ego_yaw_, o.length, o.width, o.height);
    box(corners, kPaper, 3, false);  // a rim, so that it stands out on outlines, too
    box(corners, kInk, 1.2, false);
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
      line(T_ego_world_ * places[i - 1], T_ego_world_ * places[i], color, 1.5);
    }
  }

  void drawOutline(const SceneObject& object) {
    const Color color = colorOfClass(view_.className(object), object.class_id);
    const auto corners = cornersOf(object);
    const bool muted = isMuted(view_.className(object));
    box(corners, color, muted ? 1.2 : 2, object.existence < kSureExistence);
    // A bar across the front tells front from rear.
    if (!muted && object.has_yaw) {
      const auto inward = [&](std::size_t front, std::size_t rear) -> Vector3 {
        return corners[front] + 0.2 * (corners[rear] - corners[front]);
      };
      line(inward(4, 7), inward(5, 6), color, 2);
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
  Pose3 T_ego_world_;
  double ego_yaw_;
  std::vector<Rect> taken_;  // by text that is there already
};

void Overlay::axisText(const Vector3& place, const std::string& text) {
  const auto at = pixel(place);
  if (!at) return;
  const double width = Canvas::textWidth(text, kSmallSize);
  const Rect rect{at->x() - width / 2 - 2, at->y() - kSmallSize / 2 - 2, width + 4, kSmallSize + 4};
  if (!at_.contains(rect)) return;
  for (const Rect& other : taken_) {
    if (other.overlaps(rect)) return;
  }
  canvas_.rectangle(rect, kPaper.withAlpha(0.75));
  canvas_.text({rect.x + 2, rect.bottom() - 2}, text, kSmallSize, kMutedInk);
  taken_.push_back(rect);
}

// Top: distances ahead along the left edge, to the sides along the lower edge. Driver: distances
// ahead along the lane.
void Overlay::drawAxes() {
  drawScale();
  if (camera_.kind == ViewKind::kDriver) {
    for (double x = kAxisStep; x <= 6 * kAxisStep; x += kAxisStep) {
      axisText({x, -3, 0}, fmt::format("{:.0f} m", x));
    }
    return;
  }
  const double scale = camera_.scaleAt({0, 0, 0});
  const double left = at_.width / 2 / scale - 26 / scale;
  const double lowest = camera_.T_ego_camera.translation().x() - (at_.height / 2 - 12) / scale;
  for (double x = -10 * kAxisStep; x <= 10 * kAxisStep; x += kAxisStep) {
    axisText({x, left, 0}, fmt::format("x {:.0f} m", x));
  }
  for (double y = -10 * kAxisStep; y <= 10 * kAxisStep; y += kAxisStep) {
    axisText({lowest, y, 0}, fmt::format("y {:.0f} m", y));
  }
}

void Overlay::drawScale() {
  if (camera_.kind != ViewKind::kTop) return;
  const double length = kAxisStep * camera_.scaleAt({0, 0, 0});
  const Rect box{at_.right() - length - 24, at_.bottom() - 52, length + 16, 26};
  canvas_.rectangle(box, kPaper.withAlpha(0.8));
  taken_.push_back(box);
  const Vector2 a(box.x + 8, box.bottom() - 6), b(box.right() - 8, box.bottom() - 6);
  canvas_.line(a, b, kInk, 1.5);
  for (const Vector2& end : {a, b}) {
    canvas_.line(end - Vector2(0, 4), end + Vector2(0, 4), kInk, 1.5);
  }
  const std::string text = fmt::format("{:.0f} m", kAxisStep);
  canvas_.text({(a.x() + b.x() - Canvas::textWidth(text, kSmallSize)) / 2, box.y + 3 + kSmallSize},
               text, kSmallSize, kInk);
}

// The lane as it is steered up to the first occupied cell, and a bar where it ends.
void Overlay::drawFreeDistance() {
  if (!view_.corridor) return;
  constexpr double kPiece = 2;  // [m] drawn straight, and of gap
  const Corridor& lane = *view_.corridor;
  const auto place = [&](double s, double d) -> Vector3 {
    const Vector2 p = onArc(lane, {s, d});
    return {p.x(), p.y(), 0};
  };
  const double half = lane.width / 2, end = view_.free.distance;
  for (const double d : {half, -half}) {
    for (double s = lane.from; s < end; s += 2 * kPiece) {
      line(place(s, d), place(std::min(s + kPiece, end), d), kMutedInk, 1.2);
    }
  }
  if (view_.free.blocked) line(place(end, half), place(end, -half), kInk, 3);
}

void Overlay::drawVehicle() {
  const auto a = pixel({kEgoMiddle - 1, 0, 1.6}), b = pixel({kEgoMiddle + 1.8, 0, 1.6});
  if (camera_.kind == ViewKind::kTop && a && b) canvas_.arrow(*a, *b, kPaper, 2);
  const auto corners = boxCorners({kEgoMiddle, 0, 0}, 0, 4.4, 1.8, 1.6);
  Rect frame;
  for (const Vector3& corner : corners) {
    const auto p = pixel(corner);
    if (!p) return;
    if (frame.width == 0) frame = {p->x(), p->y(), 1, 1};
    const double right = std::max(frame.right(), p->x()), low = std::max(frame.bottom(), p->y());
    frame.x = std::min(frame.x, p->x());
    frame.y = std::min(frame.y, p->y());
    frame.width = right - frame.x;
    frame.height = low - frame.y;
  }
  taken_.push_back(frame);
}

// A camera of the vehicle: its image or, where the log has none, the lidar's returns in its place;
// boxes from far to near.
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
                         kDash);
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
    line(T_ego_world_ * outline[i], T_ego_world_ * outline[(i + 1) % outline.size()], kMeasurement,
         1.2);
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

// What the object's box covers of the picture; empty when it is out of sight.
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
    // From the label's edge to the object's, where they stand apart.
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
