#pragma once
#include <vector>

#include "libperception/core/LaneMap.h"
#include "libperception/simulation/world/Lighting.h"

namespace perception {

struct Scenario;

/// Appearance of the ground of a scenario: asphalt with marked edges and center line along its
/// roads, curb, sidewalk and grass beside them; in a scenario without roads asphalt everywhere with
/// the borders of its lanes. Widths and colors assumed.
class GroundAppearance {
 public:
  explicit GroundAppearance(const Scenario& scenario);

  /// Reflectance at a position [m, world]; detail finer than `pixel` [m] is omitted.
  Rgb reflectance(const Vector2& place, double pixel) const;

 private:
  double markedByRoads(const Vector2& place, double pixel) const;
  double markedByLanes(const Vector2& place, double pixel) const;

  std::vector<Lane> roads_, lanes_;  // roads: line and width
};

}  // namespace perception
