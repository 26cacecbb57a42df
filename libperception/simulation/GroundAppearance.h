#pragma once
#include <vector>

#include "libperception/core/LaneMap.h"
#include "libperception/simulation/Lighting.h"

namespace perception {

struct Scenario;

/// What the ground of a scenario looks like from above: asphalt with marked edges and center line
/// along its roads, curb, pavement and grass beside them; in a scenario without roads asphalt
/// everywhere with the borders of its lanes. Widths and colors assumed.
class GroundAppearance {
 public:
  explicit GroundAppearance(const Scenario& scenario);

  /// Reflectance at a place [m, world]; detail finer than `pixel` [m] is left out.
  Rgb reflectance(const Vector2& place, double pixel) const;

 private:
  double markedByRoads(const Vector2& place, double pixel) const;
  double markedByLanes(const Vector2& place, double pixel) const;

  std::vector<Lane> roads_, lanes_;  // roads: line and width
};

}  // namespace perception
