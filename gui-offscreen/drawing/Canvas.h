#pragma once
#include <memory>
#include <string>
#include <vector>

#include "gui-offscreen/drawing/Palette.h"
#include "gui-offscreen/drawing/Picture.h"
#include "libperception/core/Frames.h"

namespace perception {

/// A rectangle of the picture [px].
struct Rect {
  double x = 0, y = 0, width = 0, height = 0;

  double right() const { return x + width; }
  double bottom() const { return y + height; }
  bool overlaps(const Rect& o) const {
    return x < o.right() && o.x < right() && y < o.bottom() && o.y < bottom();
  }
  bool contains(const Rect& o) const {
    return o.x >= x && o.y >= y && o.right() <= right() && o.bottom() <= bottom();
  }
};

/// Drawing area with anti-aliased lines and text, by supersampling at twice the size. Coordinates
/// are pixels of the final picture.
class Canvas {
 public:
  Canvas(int width, int height, const Color& background = kPaper);
  ~Canvas();

  /// Drawing outside of `area` has no effect until unclip().
  void clip(const Rect& area);
  void unclip();
  void paste(const Picture& picture, const Rect& to);
  void line(const Vector2& a, const Vector2& b, const Color& color, double thickness);
  void dashedLine(const Vector2& a, const Vector2& b, const Color& color, double thickness,
                  double dash);
  void polygon(const std::vector<Vector2>& corners, const Color& fill);
  void rectangle(const Rect& rect, const Color& fill);
  void disc(const Vector2& center, double radius, const Color& fill);
  /// A line with a head at b.
  void arrow(const Vector2& a, const Vector2& b, const Color& color, double thickness);
  /// ASCII; (x, y) is the left end of the base line; `size` the height of capitals [px].
  void text(const Vector2& at, const std::string& text, double size, const Color& color,
            bool bold = false);
  static double textWidth(const std::string& text, double size, bool bold = false);

  Picture picture() const;
  Rect area() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace perception
