#pragma once
#include <set>

#include "gui-offscreen/drawing/Picture.h"

namespace perception {

/// Number of distinct colors; 1 = blank.
inline std::size_t colorsOf(const Picture& picture) {
  std::set<std::uint32_t> colors;
  for (std::size_t i = 0; i + 2 < picture.rgb.size(); i += 3) {
    colors.insert(static_cast<std::uint32_t>(picture.rgb[i] << 16 | picture.rgb[i + 1] << 8 |
                                             picture.rgb[i + 2]));
  }
  return colors.size();
}

}  // namespace perception
