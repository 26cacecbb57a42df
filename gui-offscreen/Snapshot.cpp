#include "gui-offscreen/Snapshot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gui-offscreen/Legend.h"
#include "gui-offscreen/Overlay.h"

namespace perception {
namespace {

constexpr int kTitle = 30, kLegend = 216, kMargin = 10;  // [px]
constexpr int kSupersampling = 2;   // framebuffer pixels per pixel: MRPT does not smooth its edges
constexpr double kTileShare = 0.6;  // of a view's edge
constexpr int kCaption = 22;        // [px]
constexpr double kTitleSize = 10, kCaptionSize = 9;  // [px] height of capitals

std::string instantText(const SceneView& view) {
  std::string text = fmt::format("t = {:.2f} s", view.t);
  if (view.scene.frame >= 0) text += fmt::format("   frame {}", view.scene.frame);
  return text;
}

std::string titleText(const SceneView& view) {
  const auto n = view.scene.objects.size();
  std::string text = fmt::format("{}   {} object{}", instantText(view), n, n == 1 ? "" : "s");
  const double speed = view.scene.ego.velocity.norm();
  text += fmt::format("   own speed {:.0f} km/h", speed * 3.6);
  if (view.corridor) {
    text += fmt::format("   lane {} {:.0f} m", view.free.blocked ? "free for" : "free beyond",
                        view.free.distance);
  }
  return text;
}

void frameAround(Canvas& canvas, const Rect& r) {
  const Vector2 c[] = {{r.x, r.y}, {r.right(), r.y}, {r.right(), r.bottom()}, {r.x, r.bottom()}};
  for (int i = 0; i < 4; ++i) canvas.line(c[i], c[(i + 1) % 4], kMutedInk, 1);
}

ViewCamera cameraOf(ViewKind kind, double range, const Rect& at) {
  const int width = static_cast<int>(at.width), height = static_cast<int>(at.height);
  return kind == ViewKind::kTop ? ViewCamera::top(range, width, height)
                                : ViewCamera::driver(range, width, height);
}

}  // namespace

Snapshot::Snapshot(const SnapshotParams& params)
    : params_(params),
      map_width_(params.width - kLegend - 3 * kMargin),
      map_height_(params.height - kTitle - kMargin),
      renderer_(map_width_ * kSupersampling, map_height_ * kSupersampling) {}

void Snapshot::drawView(Canvas& canvas, const SceneView& view, ViewKind kind, const Rect& at) {
  const ViewCamera camera = cameraOf(kind, params_.range, at);
  canvas.paste(renderer_.render(view, camera), at);
  labels_left_out_ += drawOverlay(canvas, view, camera, at);
  frameAround(canvas, at);
}

Picture Snapshot::picture(const SceneView& view) {
  labels_left_out_ = 0;
  const int n = static_cast<int>(params_.views.size());
  Canvas canvas(n * (map_width_ + kMargin) + kLegend + 2 * kMargin, params_.height);
  double x = kMargin;
  for (const ViewKind kind : params_.views) {
    drawView(canvas, view, kind,
             {x, kTitle, static_cast<double>(map_width_), static_cast<double>(map_height_)});
    x += map_width_ + kMargin;
  }
  drawLegend(canvas, view, {x, kTitle - 8, kLegend, static_cast<double>(map_height_)});
  const double base = (kTitle + kTitleSize) / 2;
  canvas.text({kMargin, base}, view.run_name, kTitleSize, kInk, true);
  canvas.text({kMargin + Canvas::textWidth(view.run_name, kTitleSize, true) + 24, base},
              titleText(view), kTitleSize, kInk);
  return canvas.picture();
}

Picture Snapshot::tile(const SceneView& view) {
  labels_left_out_ = 0;
  const int width = static_cast<int>(map_width_ * kTileShare);
  const int height = static_cast<int>(map_height_ * kTileShare);
  const int n = static_cast<int>(params_.views.size());
  Canvas canvas(n * width + (n - 1) * kMargin, height + kCaption);
  canvas.text({2, (kCaption + kCaptionSize) / 2}, instantText(view), kCaptionSize, kInk, true);
  double x = 0;
  for (const ViewKind kind : params_.views) {
    drawView(canvas, view, kind,
             {x, kCaption, static_cast<double>(width), static_cast<double>(height)});
    x += width + kMargin;
  }
  return canvas.picture();
}

}  // namespace perception
