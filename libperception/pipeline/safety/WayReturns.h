#pragma once
#include <cstddef>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/core/Time.h"
#include "libperception/grid/beams/GridPoints.h"
#include "libperception/grid/way/FreeDistance.h"

namespace perception {

/// Where returns block the way.
struct ReturnObstacle {
  FreeDistance free;        ///< of the newest scan's nearest return that is part of it
  std::size_t returns = 0;  ///< number of returns that make it up
};

/// The returns on the way: of one scan, what moves too fast to hit a cell of the grid twice, and in
/// clear air of half a second, what is too thin to be hit by ten beams at once (method.md 8.4).
class WayReturns {
 public:
  /// The newest scan's hits with their `weights` [0, 1] (empty: all 1), and the returns that only
  /// clear, as `others`, if the air is clear; else null. `corridor`: as driven at the scan, with
  /// its road.
  void add(Stamp stamp, Corridor corridor, const GridPoints& hits,
           const std::vector<float>& weights, const GridPoints* others);

  /// Nearest place in the corridor where returns together weigh `least`. In clear air these are
  /// returns from one to the next of which it is no farther than half a meter along the corridor,
  /// one of them in the newest scan: up to `recent` [m] along it those of half a second, beyond it
  /// those of the newest scan. Else they are those of the newest scan within half a meter. Others
  /// than hits count where they stand up: where heights within half a meter along the corridor and
  /// a quarter across it differ by a tenth of a meter at least, which those of a road do not, and
  /// the highest is above a car's underside. Not blocked: none before corridor.max.
  ReturnObstacle nearest(const Corridor& corridor, double recent, double least) const;

  void clear() { scans_.clear(); }

 private:
  struct Return {
    Vector3 place;         ///< [m] world
    float height, weight;  ///< [m] above Corridor::road, [0, 1]
    bool hit;
  };
  struct Scan {
    Stamp stamp;
    bool clear;
    std::vector<Return> returns;
  };
  struct Placed;
  std::vector<Placed> placed(const Corridor& corridor, double recent) const;

  std::vector<Scan> scans_;  ///< of the last half second
};

}  // namespace perception
