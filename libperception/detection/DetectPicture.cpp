#include "libperception/detection/DetectPicture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gui-offscreen/drawing/Canvas.h"
#include "libperception/core/LowerCase.h"

namespace perception {
namespace {

constexpr double kText = 9;      // [px] height of capitals
constexpr double kFaint = 0.35;  // opacity of boxes of probability < .5
constexpr Color kTruth{255, 255, 255, 0.9};

Color colorOf(const std::string& label) {
  std::string name = lowerCase(label);
  if (name == "person") name = "pedestrian";
  return colorOfClass(name, static_cast<int>(name.size()));
}

template <class Line>
void outline(const ObjectDetection::ImageBox& b, const Line& line) {
  line(Vector2(b.x1, b.y1), Vector2(b.x2, b.y1));
  line(Vector2(b.x2, b.y1), Vector2(b.x2, b.y2));
  line(Vector2(b.x2, b.y2), Vector2(b.x1, b.y2));
  line(Vector2(b.x1, b.y2), Vector2(b.x1, b.y1));
}

// Where the object faces, as an arrow that lies on the ground: to the right at alpha 0, away from
// the viewer (up) at -90 degrees.
void drawHeading(Canvas& canvas, const ObjectDetection::ImageBox& b, double alpha,
                 const Color& color) {
  const double length = std::clamp(0.45 * (b.x2 - b.x1), 12.0, 60.0);
  const Vector2 middle(0.5 * (b.x1 + b.x2), b.y2 - 0.12 * (b.y2 - b.y1));
  const Vector2 reach(length * std::cos(alpha), 0.5 * length * std::sin(alpha));
  canvas.arrow(middle - 0.5 * reach, middle + reach, kPaper.withAlpha(0.8), 5);
  canvas.arrow(middle - 0.5 * reach, middle + reach, color, 2.5);
}

void drawName(Canvas& canvas, const ObjectDetection& o, bool calibrated, const Color& color,
              const Picture& picture) {
  const auto& b = *o.image_box;
  const std::string text = calibrated
                               ? fmt::format("{} {:.0f} %", o.label, 100 / (1 + std::exp(-o.score)))
                               : fmt::format("{} {:.2f}", o.label, o.score);
  const double width = Canvas::textWidth(text, kText) + 6, height = kText + 7;
  const double x = std::clamp(b.x1, 0.0, std::max(0.0, picture.width - width));
  const double y = b.y1 >= height ? b.y1 - height : std::min(b.y2, picture.height - height);
  canvas.rectangle({x, y, width, height}, color);
  canvas.text({x + 3, y + height - 4}, text, kText, kPaper);
}

}  // namespace

Picture detectionPicture(const Raster& image, const std::vector<ObjectDetection>& objects,
                         const std::vector<LabeledBox>& truth, bool calibrated) {
  const Picture picture = pictureOf(image);
  Canvas canvas(image.width, image.height);
  canvas.paste(picture, canvas.area());
  for (const LabeledBox& t : truth) {
    const double dash = t.ignore || t.area ? 3 : 7;
    outline(t.box, [&](const Vector2& a, const Vector2& b) {
      canvas.dashedLine(a, b, kTruth, t.ignore || t.area ? 1 : 1.6, dash);
    });
  }
  for (auto o = objects.rbegin(); o != objects.rend(); ++o) {  // the best on top
    if (!o->image_box) continue;
    Color color = colorOf(o->label);
    if (calibrated && o->score < 0) color.alpha = kFaint;
    // In a panorama a box may extend over the right border: the rest is drawn at the left one.
    for (const double shift : {0.0, -static_cast<double>(image.width)}) {
      auto b = *o->image_box;
      b.x1 += shift, b.x2 += shift;
      if (b.x2 <= 0 || b.x1 >= image.width) continue;
      outline(b,
              [&](const Vector2& from, const Vector2& to) { canvas.line(from, to, color, 2.2); });
    }
    if (o->heading && color.alpha == 1) drawHeading(canvas, *o->image_box, *o->heading, color);
  }
  for (const ObjectDetection& o : objects) {
    if (o.image_box && (!calibrated || o.score >= 0))
      drawName(canvas, o, calibrated, colorOf(o.label), picture);
  }
  return canvas.picture();
}

}  // namespace perception
