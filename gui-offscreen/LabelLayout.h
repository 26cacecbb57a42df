#pragma once
#include <optional>
#include <vector>

#include "gui-offscreen/Canvas.h"

namespace perception {

/// A label that wants to stand near its object.
struct LabelWish {
  Rect object;                   ///< [px] that it belongs to and should not cover
  double width = 0, height = 0;  ///< [px]
  int rank = 0;                  ///< lower ranks choose first
  double reach = 90;             ///< [px] farthest from the object
};

/// Places labels beside their objects so that no two of them overlap: greedily, by rank, each at
/// the nearest free place; first places that cover no other object are tried. A label that finds no
/// place within its reach is left out.
std::vector<std::optional<Rect>> placeLabels(const std::vector<LabelWish>& wishes,
                                             const std::vector<Rect>& taken, const Rect& area);

}  // namespace perception
