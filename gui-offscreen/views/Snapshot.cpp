#include "gui-offscreen/views/Snapshot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gui-offscreen/drawing/Legend.h"
#include "gui-offscreen/drawing/Overlay.h"
#include "gui-offscreen/drawing/PictureStyle.h"

namespace perception {
namespace {

constexpr int kLegend = 216;        // [px]
constexpr int kSupersampling = 2;   // framebuffer pixels per pixel: MRPT does not smooth its edges
constexpr double kTileShare = 0.6;  // of a view's edge
constexpr int kCaption = 22;        // [px]
constexpr double kCaptionSize = 9;  // [px] height of capitals
constexpr double kTallestImage = 0.8;  // of a view's height: the strip of a camera
constexpr Color kNoImage{246, 246, 246};

std::string instantText(const SceneView& view) {
  std::string text = fmt::format("t = {:.2f} s", view.t);
  if (view.scene.frame >= 0) text += fmt::format("   frame {}", view.scene.frame);
  return text;
}

std::string countText(const SceneView& view) {
  const auto n = view.scene.objects.size();
  std::string text = fmt::format("{} object{}", n, n == 1 ? "" : "s");
  const double speed = view.scene.ego.velocity.norm();
  text += fmt::format("   own speed {:.0f} km/h", speed * 3.6);
  if (view.corridor) {
    text += fmt::format("   lane {} {:.0f} m", view.free.blocked ? "free for" : "free beyond",
                        view.free.known());
  }
  return text;
}

std::string titleText(const SceneView& view) { return instantText(view) + "   " + countText(view); }

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
      renderer_(map_width_ * kSupersampling, map_height_ * kSupersampling) {
  setViews(params_.views);
}

void Snapshot::setViews(const std::vector<ViewKind>& views) {
  maps_.clear();
  with_camera_ = false;
  for (const ViewKind kind : views) {
    if (kind == ViewKind::kCamera) {
      with_camera_ = true;
    } else {
      maps_.push_back(kind);
    }
  }
}

void Snapshot::drawView(Canvas& canvas, const SceneView& view, ViewKind kind, const Rect& at) {
  if (kind == ViewKind::kCamera) return drawImage(canvas, view, at);
  const ViewCamera camera = cameraOf(kind, params_.range, at);
  canvas.paste(renderer_.render(view, camera), at);
  labels_left_out_ += drawOverlay(canvas, view, camera, at);
  frameAround(canvas, at);
}

void Snapshot::drawImage(Canvas& canvas, const SceneView& view, const Rect& at) {
  canvas.rectangle(at, kNoImage);
  std::string text = "no image yet";
  if (view.image) {
    const ViewImage& image = *view.image;
    if (image.picture.width > 0) canvas.paste(image.picture, at);
    ViewCamera camera =
        ViewCamera::image(image.camera, view.scene.ego.T_world_ego.inverse() * image.T_world_camera,
                          at.width / image.camera.width);
    camera.range = params_.range;
    labels_left_out_ += drawOverlay(canvas, view, camera, at);
    text = image.picture.width > 0
               ? fmt::format("{}, {:.0f} ms old", image.sensor, image.age * 1000)
               : fmt::format("{}: {}; lidar returns in its place", image.sensor,
                             image.missing ? "the image is missing" : "no image in the log");
  }
  const double width = Canvas::textWidth(text, kCaptionSize);
  canvas.rectangle({at.x, at.y, width + 12, kCaptionSize + 10}, kPaper.withAlpha(0.8));
  canvas.text({at.x + 6, at.y + kCaptionSize + 5}, text, kCaptionSize, kInk);
  frameAround(canvas, at);
}

// Maps in one row, or in a row a run when there are several of both; the cameras' strips below.
Snapshot::Layout Snapshot::layOut(const std::vector<SceneView>& runs) const {
  Layout layout;
  const bool several = runs.size() > 1;
  const double caption = several ? kCaption : 0;
  const bool rows = several && maps_.size() > 1;
  double x = kMargin, y = kTitle + caption, right = kMargin;
  for (std::size_t run = 0; run < runs.size(); ++run) {
    for (const ViewKind kind : maps_) {
      layout.panels.push_back({run, kind, {x, y, double(map_width_), double(map_height_)}});
      x += map_width_ + kMargin;
      right = std::max(right, x);
    }
    if (rows) {
      x = kMargin;
      y += map_height_ + kMargin + caption;
    }
  }
  if (!rows && !maps_.empty()) y += map_height_ + kMargin;
  if (with_camera_ && runs[0].layers.camera) {
    const CameraModel& camera = *runs[0].layers.camera;
    const double n = static_cast<double>(runs.size());
    if (maps_.empty()) right = kMargin + n * (map_width_ + kMargin);
    const double aspect = static_cast<double>(camera.width) / camera.height;
    const double room = (right - kMargin) / n - kMargin;
    const double width = std::floor(std::min(room, kTallestImage * map_height_ * aspect));
    const double height = std::floor(width / aspect);
    if (several && !maps_.empty()) y += caption;
    for (std::size_t run = 0; run < runs.size(); ++run) {
      const double left = kMargin + static_cast<double>(run) * (room + kMargin);
      layout.panels.push_back({run, ViewKind::kCamera, {left, y, width, height}});
    }
    y += height + kMargin;
  }
  layout.legend_x = right;
  layout.width = right + kLegend + kMargin;
  Canvas scratch(1, 1);
  layout.height = std::max(y, drawLegend(scratch, runs[0], {0, kTitle - 8, kLegend, 0}) + kMargin);
  layout.height = 2 * std::ceil(layout.height / 2);  // video codecs want even numbers
  layout.width = 2 * std::ceil(layout.width / 2);
  return layout;
}

Picture Snapshot::picture(const std::vector<SceneView>& runs) {
  labels_left_out_ = 0;
  const Layout layout = layOut(runs);
  Canvas canvas(static_cast<int>(layout.width), static_cast<int>(layout.height));
  for (const Panel& panel : layout.panels) {
    const SceneView& view = runs[panel.run];
    drawView(canvas, view, panel.kind, panel.at);
    if (runs.size() < 2) continue;
    const bool first = maps_.empty() || panel.kind == maps_.front();
    const std::string caption = first ? view.run_name + "   " + countText(view) : view.run_name;
    canvas.text({panel.at.x, panel.at.y - (kCaption - kCaptionSize) / 2}, caption, kCaptionSize,
                kInk, first);
  }
  drawLegend(canvas, runs[0], {layout.legend_x, kTitle - 8, kLegend, layout.height});
  const double base = (kTitle + kTitleSize) / 2;
  if (runs.size() == 1) {
    canvas.text({kMargin, base}, runs[0].run_name, kTitleSize, kInk, true);
    canvas.text({kMargin + Canvas::textWidth(runs[0].run_name, kTitleSize, true) + 24, base},
                titleText(runs[0]), kTitleSize, kInk);
  } else {
    canvas.text({kMargin, base}, instantText(runs[0]), kTitleSize, kInk, true);
  }
  return canvas.picture();
}

Picture Snapshot::tile(const SceneView& view) {
  labels_left_out_ = 0;
  const int width = static_cast<int>(map_width_ * kTileShare);
  const int height = static_cast<int>(map_height_ * kTileShare);
  const int n = static_cast<int>(maps_.size());
  Canvas canvas(n * width + (n - 1) * kMargin, height + kCaption);
  canvas.text({2, (kCaption + kCaptionSize) / 2}, instantText(view), kCaptionSize, kInk, true);
  double x = 0;
  for (const ViewKind kind : maps_) {
    drawView(canvas, view, kind,
             {x, kCaption, static_cast<double>(width), static_cast<double>(height)});
    x += width + kMargin;
  }
  return canvas.picture();
}

}  // namespace perception
