#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "libperception/core/Frames.h"

namespace perception {

/// Returns of one object or of several that touch, as ascending indices into the arrays given to
/// the SegmentFinder.
struct Segment {
  std::vector<std::uint32_t> points;
  /// Index in the result of the segment that it is directly a part of; -1: none.
  int whole = -1;
};

/// Link lengths of the segments (method.md 8.10).
struct LinkLength {
  double at_zero = 0.2, slope = 0.008;  ///< [m], [m/m]: grows with range as beams diverge ...
  double least = 0.3, most = 0.5;       ///< [m] ... within these bounds (fitted on View of Delft)
};

/// One level of the tree of segments.
struct LinkLevel {
  double share;     ///< [-] of the link length
  double vertical;  ///< [-] by which differences of height are multiplied
};
/// Wholes first, which bridge a car's windows (glass 0.9 to 1.4 m above the ground). All assumed.
inline constexpr LinkLevel kLinkLevels[] = {{1, 0.35}, {1, 0.7}, {0.6, 0.7}};

/// Called with each segment of the result before its parts are searched for; false: they are not.
using SegmentVisitor = std::function<bool(const Segment&)>;

/// Finds segments among obstacle returns (x, y: ego frame, height above ground; [m]): single
/// linkage in space at the smaller of the link lengths of two returns, and the parts into which a
/// segment falls at the next levels. If `sensor`, the position of the scanner (ego frame, z above
/// ground; [m]), is given, segments that grazedSurfaces() joins become parts of another whole.
/// Segments of fewer than `min_points` returns (sums of `weight`: trust, [0, 1]; empty: all 1) are
/// left out, and a whole that would keep fewer than two parts is not split at that level. Wholes
/// longer than `max_size` [m] are replaced by their parts. Borrows the vectors.
class SegmentFinder {
 public:
  SegmentFinder(const std::vector<float>& x, const std::vector<float>& y,
                const std::vector<float>& height, double min_points, double max_size,
                const std::vector<float>& weight, const std::optional<Vector3>& sensor,
                const LinkLength& link = {});
  ~SegmentFinder();

  /// Number of trees: groups of the first level, or what grazedSurfaces() joins of them.
  std::size_t trees() const;
  /// The segments of a tree, each before its parts, and these in the order of their first returns;
  /// `whole` is an index into them. Several threads may call it.
  std::vector<Segment> find(std::size_t tree, const SegmentVisitor& visit = {}) const;

 private:
  class Trees;
  std::unique_ptr<const Trees> trees_;
};

}  // namespace perception
