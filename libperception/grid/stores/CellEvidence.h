#pragma once
#include <cstdint>

#include "libperception/grid/GridParams.h"

namespace perception {

/// Integer coordinates of a cell in the world frame.
struct CellIndex {
  std::int64_t x = 0, y = 0, z = 0;
};

/// [log-odds] by which a hit of known weight resets a free cell (negative log-odds): a return
/// trusted as surface means that an object has entered. Hits of unknown trust may be of
/// precipitation and only accumulate.
inline double voidedBy(double weight, double log_odds) {
  return log_odds < 0 ? -weight * log_odds : 0;
}

/// Evidence of one scan about one cell.
struct CellEvidence {
  CellIndex cell;
  double weight = 0;     ///< [0, 1] largest of the cell's hits
  bool crossed = false;  ///< a clearing ray went through
  bool judged = false;   ///< the hits of the scan have weights

  /// [log-odds] w hit + (1 - w) miss, the miss only where a beam passed, plus voidedBy() of
  /// `before` for hits with weights.
  double logOdds(const GridParams& params, double before) const {
    return weight * params.hit + (crossed ? (1 - weight) * params.miss : 0) +
           (judged ? voidedBy(weight, before) : 0);
  }
};

}  // namespace perception
