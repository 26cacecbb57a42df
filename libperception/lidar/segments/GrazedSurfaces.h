#pragma once
#include <cstdint>
#include <vector>

#include "libperception/lidar/segments/ReturnDirections.h"

namespace perception {

/// Groups that belong to one object whose surface is seen at a grazing angle, where neighboring
/// returns are farther apart than they are linked (method.md 8.10). Side by side: the side of a
/// parked car ahead is a row of upright columns; two groups are joined when no column fits between
/// them, they overlap in height, and with a third column they lie on a line. One behind the other:
/// a cabin or a roof is joined with the hood or the rear before and below it. Numbers of the groups
/// of each set of two or more, ascending; sets in the order of their first groups. `directions` of
/// `places`, `step`: their azimuthStep().
std::vector<std::vector<std::uint32_t>> grazedSurfaces(const ReturnPlaces& places,
                                                       const std::vector<ReturnGroup>& groups,
                                                       const Vector3& sensor,
                                                       const ReturnDirections& directions,
                                                       double step);

}  // namespace perception
