#include "gui-offscreen/views/ContactSheet.h"

#include <algorithm>
#include <cmath>

#include "gui-offscreen/drawing/Canvas.h"
#include "gui-offscreen/drawing/Legend.h"
#include "gui-offscreen/drawing/PictureStyle.h"

namespace perception {
namespace {

constexpr int kLegendWidth = 216, kLegendHeight = 620;  // [px] that a full legend takes

}  // namespace

Picture contactSheet(const std::vector<Picture>& tiles, const SceneView& view) {
  const int n = static_cast<int>(tiles.size());
  const int width = n ? tiles[0].width : 0, height = n ? tiles[0].height : 0;
  // As many columns as make the sheet about 3 : 2.
  const double ideal = n ? std::sqrt(n * 1.5 * height / width) : 1;
  const int columns = std::clamp(static_cast<int>(std::lround(ideal)), 1, std::max(1, n));
  const int rows = (n + columns - 1) / columns;
  const int legend_x = kMargin + columns * (width + kMargin);
  Canvas canvas(legend_x + kLegendWidth + kMargin,
                kTitle + std::max(kLegendHeight, rows * (height + kMargin)));
  for (int i = 0; i < n; ++i) {
    const double x = kMargin + i % columns * (width + kMargin);
    const double y = kTitle + i / columns * (height + kMargin);
    canvas.paste(tiles[static_cast<std::size_t>(i)],
                 {x, y, static_cast<double>(width), static_cast<double>(height)});
  }
  canvas.text({kMargin, (kTitle + kTitleSize) / 2}, view.run_name, kTitleSize, kInk, true);
  drawLegend(canvas, view, {static_cast<double>(legend_x), kTitle, kLegendWidth, kLegendHeight});
  return canvas.picture();
}

}  // namespace perception
