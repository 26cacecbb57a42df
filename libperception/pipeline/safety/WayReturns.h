#pragma once
#include <cstddef>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/core/Time.h"
#include "libperception/grid/beams/GridPoints.h"
#include "libperception/grid/way/FreeDistance.h"
#include "libperception/measurement/frames/PhantomCauses.h"

namespace perception {

/// Where returns block the way.
struct ReturnObstacle {
  FreeDistance free;        ///< of the newest scan's nearest return that is part of it
  std::size_t returns = 0;  ///< number of returns that make it up
};

/// The returns on the way: of one scan, what moves too fast to hit a cell of the grid twice, and
/// where the air is clear of half a second, what is too thin to be hit by ten beams at once
/// (method.md 8.4).
class WayReturns {
 public:
  /// The newest scan's hits with their `weights` [0, 1] (empty: all 1), and as `others` the returns
  /// that only clear. `corridor`: as driven at the scan, with its road; `unseen` of it as by
  /// RoadHeights::along(), empty: all is seen. `causes`: of phantoms.
  void add(Stamp stamp, Corridor corridor, const std::vector<float>& unseen, const GridPoints& hits,
           const std::vector<float>& weights, const GridPoints& others,
           const PhantomCauses& causes);

  /// Nearest place in the corridor where returns together weigh `least`: hits of the newest scan
  /// within half a meter along the corridor, or returns where nothing makes phantoms, from one to
  /// the next of which it is no farther than half a meter, and between scans no farther than that
  /// and the way that the vehicle drove (1 m at most), one of them in the newest scan: up to
  /// `recent` [m] along the corridor those of half a second, beyond it those of the newest scan.
  /// Those about which an earlier scan had many more than the newest one have left and do not
  /// count. Others than hits count where they stand up: where heights up to half a meter, within
  /// half a meter along the corridor and a quarter across it, differ by a tenth of a meter at
  /// least, which those of a road do not, and the highest is above a car's underside. So do hits so
  /// far behind the last road seen that the road itself may rise to them. Not blocked: none before
  /// corridor.max.
  ReturnObstacle nearest(const Corridor& corridor, double recent, double least) const;

  void clear() { scans_.clear(), step_ = 0; }

 private:
  struct Return {
    Vector3 place;         ///< [m] world
    float height, weight;  ///< [m] above Corridor::road, [0, 1]
    bool hit;
    bool sure;     ///< nothing makes phantoms there
    bool on_road;  ///< a hit that may be of the road
  };
  struct Scan {
    Stamp stamp;
    Vector3 vehicle;  ///< [m] ego origin, world
    std::vector<Return> returns;
  };
  struct Placed;
  struct Found {
    const Placed* at = nullptr;
    std::size_t returns = 0;
  };
  Found chained(const std::vector<Placed>& all, double least) const;
  std::vector<char> whatHasLeft(const std::vector<Placed>& all) const;
  static void keepWhatStandsUp(const Corridor& corridor, std::vector<Placed>& all);
  static Found together(const std::vector<Placed>& all, double least);
  std::vector<Placed> placed(const Corridor& corridor, double recent) const;

  std::vector<Scan> scans_;  ///< of the last half second
  double step_ = 0;          ///< [m] that the vehicle drove between the newest two
};

}  // namespace perception
