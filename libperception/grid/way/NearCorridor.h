#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "libperception/grid/beams/GridPoints.h"
#include "libperception/grid/way/FreeDistance.h"

namespace perception {

/// Indices of the points that may lie in the corridor between -`end` and `end` [m] along its arc,
/// in their order: all that arcPlace() puts there and few others, by bounds in floats. With p from
/// the ego origin, r = |p| and k the curvature: a chord is never longer than its arc, hence
/// r <= |s| + |d|, and |d| >= |p_y - k r^2 / 2| / (1 + |k| r / 2). Points that are not finite are
/// left out.
std::vector<std::uint32_t> nearCorridor(const Corridor& corridor, double end,
                                        const GridPoints& points);

/// arcPlace() of a place [m, ego frame]; none: it lies farther than `side` [m] beside the arc.
std::optional<ArcPlace> arcPlaceWithin(const Corridor& corridor, double x, double y, double side);
/// The s of arcPlace() alone [m].
double alongArc(const Corridor& corridor, double x, double y);

}  // namespace perception
