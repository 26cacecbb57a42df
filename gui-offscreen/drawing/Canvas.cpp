#include "gui-offscreen/drawing/Canvas.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace perception {
namespace {

constexpr int kScale = 2;     // drawn pixels per pixel
constexpr int kFraction = 4;  // bits of sub-pixel places in OpenCV's drawing
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kCapitals = 21;     // [px] height of that font's capitals at scale 1
constexpr double kFarthest = 20000;  // [px] limit of OpenCV's fixed-point coordinates

cv::Scalar cvColorOf(const Color& c) { return {double(c.r), double(c.g), double(c.b)}; }

cv::Point fixedPoint(const Vector2& p) {
  const auto fixed = [](double v) {
    return static_cast<int>(
        std::lround(std::clamp(v, -kFarthest, kFarthest) * kScale * (1 << kFraction)));
  };
  return {fixed(p.x()), fixed(p.y())};
}

cv::Rect pixelsOf(const Rect& r) {
  const auto px = [](double v) { return static_cast<int>(std::lround(v * kScale)); };
  return {px(r.x), px(r.y), px(r.right()) - px(r.x), px(r.bottom()) - px(r.y)};
}

int strokeOf(double thickness) {
  return std::max(1, static_cast<int>(std::lround(thickness * kScale)));
}

double fontScale(double size) { return size * kScale / kCapitals; }

int fontStroke(double size, bool bold) {
  return std::max(1, static_cast<int>(std::lround(size * kScale * (bold ? 0.15 : 0.1))));
}

}  // namespace

struct Canvas::Impl {
  cv::Mat whole;
  cv::Mat view;          // of whole, within the clip
  Vector2 offset{0, 0};  // [px] of view in whole

  Vector2 local(const Vector2& p) const { return p - offset; }

  // Draws through a copy where the color is translucent.
  template <class Draw>
  void blend(const Color& color, cv::Rect box, Draw draw) {
    box &= cv::Rect(0, 0, view.cols, view.rows);
    if (box.empty() || color.alpha <= 0) return;
    if (color.alpha >= 1) return draw(view);
    cv::Mat below = view(box).clone();
    draw(view);
    cv::addWeighted(view(box), color.alpha, below, 1 - color.alpha, 0, view(box));
  }
};

Canvas::Canvas(int width, int height, const Color& background) : impl_(new Impl) {
  impl_->whole.create(height * kScale, width * kScale, CV_8UC3);
  impl_->whole = cvColorOf(background);
  unclip();
}

Canvas::~Canvas() = default;

Rect Canvas::area() const {
  return {0, 0, static_cast<double>(impl_->whole.cols) / kScale,
          static_cast<double>(impl_->whole.rows) / kScale};
}

void Canvas::clip(const Rect& area) {
  const cv::Rect box = pixelsOf(area) & cv::Rect(0, 0, impl_->whole.cols, impl_->whole.rows);
  impl_->view = impl_->whole(box);
  impl_->offset = Vector2(box.x, box.y) / kScale;
}

void Canvas::unclip() {
  impl_->view = impl_->whole;
  impl_->offset = Vector2::Zero();
}

void Canvas::paste(const Picture& picture, const Rect& to) {
  const cv::Mat from(picture.height, picture.width, CV_8UC3,
                     const_cast<std::uint8_t*>(picture.rgb.data()));
  cv::Mat target = impl_->whole(pixelsOf(to));
  if (from.size() == target.size()) {
    from.copyTo(target);
  } else {
    cv::resize(from, target, target.size(), 0, 0, cv::INTER_AREA);
  }
}

void Canvas::line(const Vector2& a, const Vector2& b, const Color& color, double thickness) {
  const cv::Point p = fixedPoint(impl_->local(a)), q = fixedPoint(impl_->local(b));
  const int stroke = strokeOf(thickness);
  cv::Rect box(cv::Point(std::min(p.x, q.x), std::min(p.y, q.y)) / (1 << kFraction) -
                   cv::Point(stroke + 2, stroke + 2),
               cv::Point(std::max(p.x, q.x), std::max(p.y, q.y)) / (1 << kFraction) +
                   cv::Point(stroke + 3, stroke + 3));
  impl_->blend(color, box, [&](cv::Mat& on) {
    cv::line(on, p, q, cvColorOf(color), stroke, cv::LINE_AA, kFraction);
  });
}

void Canvas::dashedLine(const Vector2& a, const Vector2& b, const Color& color, double thickness,
                        double dash) {
  const double length = (b - a).norm();
  if (!(length > 0) || length > kFarthest) return;
  const Vector2 along = (b - a) / length;
  for (double at = 0; at < length; at += 2 * dash) {
    line(a + at * along, a + std::min(at + dash, length) * along, color, thickness);
  }
}

void Canvas::polygon(const std::vector<Vector2>& corners, const Color& fill) {
  std::vector<cv::Point> points;
  cv::Rect box;
  for (const Vector2& corner : corners) {
    points.push_back(fixedPoint(impl_->local(corner)));
    const cv::Rect one(points.back() / (1 << kFraction) - cv::Point(2, 2), cv::Size(5, 5));
    box = box.empty() ? one : box | one;
  }
  impl_->blend(fill, box, [&](cv::Mat& on) {
    cv::fillConvexPoly(on, points, cvColorOf(fill), cv::LINE_AA, kFraction);
  });
}

void Canvas::rectangle(const Rect& r, const Color& fill) {
  polygon({{r.x, r.y}, {r.right(), r.y}, {r.right(), r.bottom()}, {r.x, r.bottom()}}, fill);
}

void Canvas::disc(const Vector2& center, double radius, const Color& fill) {
  const cv::Point at = fixedPoint(impl_->local(center));
  const int r = static_cast<int>(std::lround(radius * kScale * (1 << kFraction)));
  const cv::Point corner((r >> kFraction) + 2, (r >> kFraction) + 2);
  impl_->blend(fill, cv::Rect(at / (1 << kFraction) - corner, at / (1 << kFraction) + corner),
               [&](cv::Mat& on) {
                 cv::circle(on, at, r, cvColorOf(fill), cv::FILLED, cv::LINE_AA, kFraction);
               });
}

void Canvas::arrow(const Vector2& a, const Vector2& b, const Color& color, double thickness) {
  const double length = (b - a).norm();
  if (!(length > 0)) return;
  const Vector2 along = (b - a) / length, across(-along.y(), along.x());
  const double head = std::min(5 + 2 * thickness, length);  // [px]
  line(a, b - head * along * 0.8, color, thickness);
  polygon({b, b - head * along + 0.45 * head * across, b - head * along - 0.45 * head * across},
          color);
}

void Canvas::text(const Vector2& at, const std::string& text, double size, const Color& color,
                  bool bold) {
  const Vector2 p = impl_->local(at) * kScale;
  cv::putText(impl_->view, text,
              {static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y()))}, kFont,
              fontScale(size), cvColorOf(color), fontStroke(size, bold), cv::LINE_AA);
}

double Canvas::textWidth(const std::string& text, double size, bool bold) {
  int base = 0;
  return static_cast<double>(
             cv::getTextSize(text, kFont, fontScale(size), fontStroke(size, bold), &base).width) /
         kScale;
}

Picture Canvas::picture() const {
  cv::Mat small;
  cv::resize(impl_->whole, small, impl_->whole.size() / kScale, 0, 0, cv::INTER_AREA);
  Picture picture{small.cols, small.rows, {}};
  picture.rgb.assign(small.datastart, small.dataend);
  return picture;
}

}  // namespace perception
