#pragma once
#include <cstdint>
#include <vector>

#include "libperception/lidar/segments/DirectionCells.h"

namespace perception {

/// Of returns of one cluster, `points` (indices into those of `cells`), those on a surface, as
/// indices into `points`, ascending. The others are loose: most beams beside one pass and return
/// from farther away, as in a plume or in spray before a vehicle. All where more than half are
/// loose: such a cluster has no surface to be told from. Where loose ones hang before a surface,
/// what else lies before it is left out, too: the lumps of the cloud let no beam pass. `cells`: of
/// `all`; method.md 8.10.
std::vector<std::uint32_t> surfaceReturns(const EgoPoints& all, const DirectionCells& cells,
                                          const std::vector<std::uint32_t>& points);

/// Of each of `points` the share of the directions about it that end at its range, as
/// PlacedReturns::solid; those that end well before it tell nothing. Up to
/// PlacedReturns::kFlakesWithin these are 25, of which half have to tell, beyond it nine; method.md
/// 8.4.
std::vector<float> solidShares(const DirectionCells& cells,
                               const std::vector<std::uint32_t>& points);

}  // namespace perception
