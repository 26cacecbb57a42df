#include <fmt/format.h>

#include <algorithm>

#include "gui-offscreen/drawing/PictureStyle.h"
#include "gui-offscreen/drawing/ViewPen.h"

namespace perception {
namespace {

constexpr double kAxisStep = 10;  // [m]

class Surroundings {
 public:
  Surroundings(ViewPen& pen, const SceneView& view) : pen_(pen), view_(view) {}

  std::vector<Rect> draw() {
    drawAxes();
    drawFreeDistance();
    drawVehicle();
    return std::move(taken_);
  }

 private:
  void drawAxes();
  void axisText(const Vector3& place, const std::string& text);
  void drawScale();
  void drawFreeDistance();
  void drawVehicle();

  ViewPen& pen_;
  const SceneView& view_;
  std::vector<Rect> taken_;
};

void Surroundings::axisText(const Vector3& place, const std::string& text) {
  const auto at = pen_.pixel(place);
  if (!at) return;
  const double width = Canvas::textWidth(text, kSmallSize);
  const Rect rect{at->x() - width / 2 - 2, at->y() - kSmallSize / 2 - 2, width + 4, kSmallSize + 4};
  if (!pen_.at().contains(rect)) return;
  for (const Rect& other : taken_) {
    if (other.overlaps(rect)) return;
  }
  pen_.canvas().rectangle(rect, kPaper.withAlpha(0.75));
  pen_.canvas().text({rect.x + 2, rect.bottom() - 2}, text, kSmallSize, kMutedInk);
  taken_.push_back(rect);
}

// Top: distances ahead along the left edge, to the sides along the lower edge. Driver: distances
// ahead along the lane.
void Surroundings::drawAxes() {
  drawScale();
  if (pen_.camera().kind == ViewKind::kDriver) {
    for (double x = kAxisStep; x <= 6 * kAxisStep; x += kAxisStep) {
      axisText({x, -3, 0}, fmt::format("{:.0f} m", x));
    }
    return;
  }
  const double scale = pen_.camera().scaleAt({0, 0, 0});
  const double left = pen_.at().width / 2 / scale - 26 / scale;
  const double lowest =
      pen_.camera().T_ego_camera.translation().x() - (pen_.at().height / 2 - 12) / scale;
  for (double x = -10 * kAxisStep; x <= 10 * kAxisStep; x += kAxisStep) {
    axisText({x, left, 0}, fmt::format("x {:.0f} m", x));
  }
  for (double y = -10 * kAxisStep; y <= 10 * kAxisStep; y += kAxisStep) {
    axisText({lowest, y, 0}, fmt::format("y {:.0f} m", y));
  }
}

void Surroundings::drawScale() {
  if (pen_.camera().kind != ViewKind::kTop) return;
  const double length = kAxisStep * pen_.camera().scaleAt({0, 0, 0});
  const Rect box{pen_.at().right() - length - 24, pen_.at().bottom() - 52, length + 16, 26};
  pen_.canvas().rectangle(box, kPaper.withAlpha(0.8));
  taken_.push_back(box);
  const Vector2 a(box.x + 8, box.bottom() - 6), b(box.right() - 8, box.bottom() - 6);
  pen_.canvas().line(a, b, kInk, 1.5);
  for (const Vector2& end : {a, b}) {
    pen_.canvas().line(end - Vector2(0, 4), end + Vector2(0, 4), kInk, 1.5);
  }
  const std::string text = fmt::format("{:.0f} m", kAxisStep);
  pen_.canvas().text(
      {(a.x() + b.x() - Canvas::textWidth(text, kSmallSize)) / 2, box.y + 3 + kSmallSize}, text,
      kSmallSize, kInk);
}

// The steering corridor up to the first occupied cell, and a bar at its end.
void Surroundings::drawFreeDistance() {
  if (!view_.corridor) return;
  constexpr double kPiece = 2;  // [m] drawn straight, and of gap
  const Corridor& lane = *view_.corridor;
  const auto place = [&](double s, double d) -> Vector3 {
    const Vector2 p = onArc(lane, {s, d});
    return {p.x(), p.y(), 0};
  };
  const double half = lane.width / 2, end = view_.free.known();
  for (const double d : {half, -half}) {
    for (double s = lane.from; s < end; s += 2 * kPiece) {
      pen_.line(place(s, d), place(std::min(s + kPiece, end), d), kMutedInk, 1.2);
    }
  }
  if (view_.free.blocked) pen_.line(place(end, half), place(end, -half), kInk, 3);
}

void Surroundings::drawVehicle() {
  const auto a = pen_.pixel({kEgoMiddle - 1, 0, 1.6}), b = pen_.pixel({kEgoMiddle + 1.8, 0, 1.6});
  if (pen_.camera().kind == ViewKind::kTop && a && b) pen_.canvas().arrow(*a, *b, kPaper, 2);
  const auto corners = boxCorners({kEgoMiddle, 0, 0}, 0, 4.4, 1.8, 1.6);
  Rect frame;
  for (const Vector3& corner : corners) {
    const auto p = pen_.pixel(corner);
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

}  // namespace

std::vector<Rect> drawSurroundings(ViewPen& pen, const SceneView& view) {
  return Surroundings(pen, view).draw();
}

}  // namespace perception
