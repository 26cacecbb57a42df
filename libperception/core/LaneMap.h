#pragma once
#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "libperception/core/Frames.h"

namespace perception {

/// A lane: its center line in driving direction, world frame.
struct Lane {
  std::string name;
  std::vector<Vector2> points;  ///< [m] at least two; consecutive points differ
  double width = 3.5;           ///< [m]
  bool one_way = true;          ///< false: driven in both directions: only its axis is known
};

/// Direction and lateral offset at a position on a lane.
struct LanePlace {
  double direction = 0;  ///< [rad] of driving, world
  double offset = 0;     ///< [m] to the left of the center line
  bool one_way = true;
  std::size_t lane = 0;  ///< index into LaneMap::lanes()
};

/// Lanes, found by position.
class LaneMap {
 public:
  explicit LaneMap(std::vector<Lane> lanes);
  /// FILE.lanes.csv: `lane,x,y,width,one_way`, one line per point, the points of one lane together
  /// and in driving direction; x, y and width in meters, world frame. Throws DataError with file
  /// and line.
  static LaneMap fromFile(const std::string& path);

  const std::vector<Lane>& lanes() const { return lanes_; }
  /// All lanes that cover the position [m, world], the one with the nearest center line first.
  std::vector<LanePlace> at(const Vector2& place) const;

 private:
  struct Segment {
    std::uint32_t lane, first;  // from point `first` of the lane to the next one
  };
  static std::int64_t cellOf(double x, double y);

  std::vector<Lane> lanes_;
  std::unordered_map<std::int64_t, std::vector<Segment>> cells_;  // segments that may cover a cell
};

/// The content of FILE.lanes.csv.
std::string lanesText(const std::vector<Lane>& lanes);

}  // namespace perception
