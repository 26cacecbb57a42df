#pragma once
#include <optional>
#include <vector>

#include "gui-offscreen/drawing/Canvas.h"

namespace perception {

/// A label to be placed near its object.
struct LabelWish {
  Rect object;                   ///< [px] labeled object, should not be covered
  double width = 0, height = 0;  ///< [px]
  int rank = 0;                  ///< lower ranks are placed first
  double reach = 90;             ///< [px] largest distance from the object
};

/// Places labels beside their objects so that no two of them overlap: greedily by rank, at the
/// nearest free position, preferably one that covers no other object. Empty for a label without a
/// position within its reach.
std::vector<std::optional<Rect>> placeLabels(const std::vector<LabelWish>& wishes,
                                             const std::vector<Rect>& taken, const Rect& area);

}  // namespace perception
