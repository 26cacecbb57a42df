#include "gui-offscreen/drawing/Legend.h"

#include <fmt/format.h>

#include <algorithm>

#include "gui-offscreen/drawing/Overlay.h"

namespace perception {
namespace {

constexpr double kTextSize = 8;  // [px]
constexpr double kHeadSize = 9;  // [px]
constexpr double kRow = 22;      // [px]
constexpr double kSymbol = 34;   // [px] width of the column of symbols

/// Rows of symbol and text, one below the other. `bottom()` is where they end.
class Legend {
 public:
  Legend(Canvas& canvas, const Rect& at) : canvas_(canvas), at_(at), y_(at.y) {}

  void head(const std::string& text) {
    y_ += 8;
    canvas_.text({at_.x, y_ + kHeadSize}, text, kHeadSize, kInk, true);
    y_ += kHeadSize + 8;
  }
  double bottom() const { return y_; }
  void text(const std::string& text) {
    canvas_.text({at_.x + kSymbol + 8, y_ + (kRow + kTextSize) / 2}, text, kTextSize, kInk);
    y_ += kRow;
  }
  void more(const std::string& text) {
    y_ -= 7;
    this->text(text);
  }
  void boxRow(const Color& color, double fill, bool dashed, const std::string& label) {
    const Rect r{at_.x + 3, y_ + 4, kSymbol - 6, kRow - 8};
    canvas_.rectangle(r, color.withAlpha(fill));
    outline(r, color, dashed, 2);
    text(label);
  }
  void truthRow(const std::string& label) {
    outline({at_.x + 3, y_ + 4, kSymbol - 6, kRow - 8}, kInk, false, 1);
    text(label);
  }
  void arrowRow(const std::string& label) {
    canvas_.arrow(middle(2), middle(kSymbol - 2), kInk, 2);
    text(label);
  }
  void lineRow(const Color& color, const std::string& label) {
    canvas_.line(middle(2), middle(kSymbol - 2), color, 1.5);
    text(label);
  }
  void dashedRow(const std::string& label) {
    canvas_.dashedLine(middle(2) - Vector2(0, 4), middle(kSymbol - 5) - Vector2(0, 4), kMutedInk, 1,
                       4);
    canvas_.dashedLine(middle(2) + Vector2(0, 4), middle(kSymbol - 5) + Vector2(0, 4), kMutedInk, 1,
                       4);
    canvas_.line(middle(kSymbol - 3) - Vector2(0, 5), middle(kSymbol - 3) + Vector2(0, 5), kInk, 3);
    text(label);
  }
  void radarRow(bool moving, const std::string& label) {
    canvas_.disc(middle(moving ? 6 : kSymbol / 2), 2.4, kRadarReturn);
    if (moving) canvas_.arrow(middle(6), middle(kSymbol - 3), kRadarReturn, 1.5);
    text(label);
  }
  void markRow(Modality modality, const std::string& label) {
    drawMeasurementMark(canvas_, middle(kSymbol / 2), modality);
    text(label);
  }
  void dashedBoxRow(const Color& color, const std::string& label) {
    outline({at_.x + 3, y_ + 4, kSymbol - 6, kRow - 8}, color, true, 1.5);
    text(label);
  }
  void squaresRow(const Color& color, const std::string& label) {
    for (const double x : {8.0, 14.0, 20.0}) {
      canvas_.rectangle({at_.x + x, y_ + kRow / 2 - 3, 5, 5}, color);
    }
    text(label);
  }
  void pointsRow(const Color& color, const std::string& label) {
    for (int i = 0; i < 6; ++i) {
      canvas_.disc(middle(6 + 4.5 * i) + Vector2(0, i % 2 ? 2 : -2), 1, color);
    }
    text(label);
  }
  void filledRow(const Color& color, const std::string& label) {
    const Rect r{at_.x + 3, y_ + 5, kSymbol - 6, kRow - 10};
    canvas_.rectangle(r, color.withAlpha(0.85));
    canvas_.arrow(middle(9), middle(kSymbol - 6), kPaper, 2);
    text(label);
  }
  void heightBar() {
    const double width = at_.width - kSymbol - 20;
    const Rect bar{at_.x + 3, y_ + 2, width + kSymbol, 9};
    constexpr int kSteps = 60;
    for (int i = 0; i < kSteps; ++i) {
      const double share = i / (kSteps - 1.0);
      canvas_.rectangle(
          {bar.x + bar.width * i / kSteps, bar.y, bar.width / kSteps + 0.6, bar.height},
          colorOfHeight(kHeightLow + share * (kHeightHigh - kHeightLow)));
    }
    const std::string low = fmt::format("{:g} m", kHeightLow),
                      high = fmt::format("{:g} m", kHeightHigh);
    const double base = bar.bottom() + 4 + kTextSize;
    canvas_.text({bar.x, base}, low, kTextSize, kInk);
    canvas_.text({bar.right() - Canvas::textWidth(high, kTextSize), base}, high, kTextSize, kInk);
    y_ = base + 6;
  }

 private:
  Vector2 middle(double x) const { return {at_.x + x, y_ + kRow / 2}; }
  void outline(const Rect& r, const Color& color, bool dashed, double thickness) {
    const Vector2 c[] = {{r.x, r.y}, {r.right(), r.y}, {r.right(), r.bottom()}, {r.x, r.bottom()}};
    for (int i = 0; i < 4; ++i) {
      if (dashed) {
        canvas_.dashedLine(c[i], c[(i + 1) % 4], color, thickness, 4);
      } else {
        canvas_.line(c[i], c[(i + 1) % 4], color, thickness);
      }
    }
  }

  Canvas& canvas_;
  Rect at_;
  double y_;
};

}  // namespace

double drawLegend(Canvas& canvas, const SceneView& view, const Rect& at) {
  Legend legend(canvas, at);
  legend.head("Tracked objects");
  for (std::size_t i = 0; i < view.class_names.size(); ++i) {
    std::string name = view.class_names[i];
    const Color color = colorOfClass(name, static_cast<int>(i));
    std::replace(name.begin(), name.end(), '_', ' ');
    legend.boxRow(color, 0.45, false, name);
  }
  const Color any = colorOfClass(view.class_names.empty() ? "" : view.class_names[0], 0);
  legend.boxRow(any, 0.45, false, fmt::format("existence >= {:g}", kSureExistence));
  legend.boxRow(any, 0.12, true, "less certain to exist");
  legend.arrowRow("velocity: way of 1 s");
  legend.lineRow(kInk, "path of the last 2 s");
  legend.text("id class P(class), speed");
  legend.more("'?': P(class) < 0.95");
  if (view.layers.thing_ids) legend.more("static-other: id alone");
  if (view.has_truth) {
    legend.head("Truth");
    legend.truthRow("annotated object");
  }
  legend.head("Vehicle");
  legend.filledRow(kEgo, "own vehicle");
  if (view.corridor) legend.dashedRow("lane free of obstacles");
  if (view.layers.lidar) {
    legend.head("Lidar");
    legend.squaresRow(kOccupied, "safety grid: occupied");
    legend.pointsRow(kGroundPoint, "ground");
    if (view.layers.trust) legend.pointsRow(kPhantom, "rain, snow or spray");
    legend.pointsRow(colorOfHeight(1), "obstacle, by height:");
    legend.heightBar();
  }
  if (view.layers.radar) {
    legend.head("Radar");
    legend.radarRow(false, "return");
    legend.radarRow(true, "radial speed: way of 1 s");
  }
  if (view.layers.measurements) {
    legend.head("Measurements");
    legend.markRow(Modality::kLidar, "lidar: cluster, person");
    if (view.layers.detector_boxes) legend.markRow(Modality::kCamera, "camera");
    if (view.layers.radar) legend.markRow(Modality::kRadar, "radar");
  }
  if (view.layers.camera && view.layers.detector_boxes) {
    legend.head("Camera");
    legend.dashedBoxRow(kDetectorBox, "box of the detector");
  }
  return legend.bottom();
}

}  // namespace perception
