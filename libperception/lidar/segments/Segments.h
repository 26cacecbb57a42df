#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "libperception/core/Frames.h"

namespace perception {

/// A group of returns that are one thing or several that touch, as indices into the arrays given to
/// findSegments(), ascending.
struct Segment {
  std::vector<std::uint32_t> points;
  /// Index of the segment that this one is a part of; -1: it is whole.
  int whole = -1;
};

/// Link lengths of the segments (method.md 8.10).
struct LinkLength {
  double at_zero = 0.2, slope = 0.008;  ///< [m], [m/m]: grows with the range as the beams part ...
  double least = 0.3, most = 0.5;       ///< [m] ... within these bounds (fitted on View of Delft)
};

/// One level of the tree of segments.
struct LinkLevel {
  double share;     ///< of the link length
  double vertical;  ///< [-] weight of differences of height
};
/// From wholes, whose windows may part them (0.9 to 1.4 m of glass), to parts. All assumed.
inline constexpr LinkLevel kLinkLevels[] = {{1, 0.35}, {1, 0.7}, {0.6, 0.7}};

/// Called with every segment when it is found, before its parts; false: its parts are not wanted.
using SegmentVisitor = std::function<bool(const Segment&)>;

/// Segments among obstacle returns (x, y: ego frame, height above ground; [m]): single linkage in
/// space at the smaller of the link lengths of two returns, and the parts into which a segment
/// falls at the next levels. With the position of the scanner (ego frame, z above ground; [m])
/// those that belong together by grazedSurfaces() are the parts of a whole of their own. A whole
/// comes before its parts; those of one whole are in the order of their first returns. Segments of
/// fewer than `min_points` returns (sums of `weight`: trust, [0, 1]; empty: all 1) are left out,
/// and a whole of which fewer than two parts would be left has none at that level. Of wholes longer
/// than `max_size` [m] the parts stand alone.
std::vector<Segment> findSegments(const std::vector<float>& x, const std::vector<float>& y,
                                  const std::vector<float>& height, double min_points,
                                  double max_size, const std::vector<float>& weight = {},
                                  const SegmentVisitor& visit = {},
                                  const std::optional<Vector3>& sensor = {},
                                  const LinkLength& link = {});

}  // namespace perception
