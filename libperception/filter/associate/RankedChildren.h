#pragma once
#include <cstdint>
#include <vector>

#include "libperception/filter/associate/Association.h"

namespace perception {

/// Limits on the child hypotheses of a scan.
struct RankingLimits {
  std::size_t children = 4;  ///< most children of one hypothesis
  std::size_t slots = 1;     ///< most children of all hypotheses
  double span = 14;          ///< largest difference of log weight to the best child
};

/// One association of one hypothesis.
struct RankedChild {
  std::size_t parent = 0;  ///< index of the hypothesis
  Association association;
  double log_weight = 0;  ///< sum of those of the parent and of the association
};

/// Pass 3 for all hypotheses at once: their best associations, best first, with exact weights
/// (method.md 6). The scan is split into parts whose measurements share no candidate tracks;
/// hypotheses that hold the same tracks in a part share its ranking, and associations that cannot
/// be among the best `slots` of all hypotheses are not generated. `tracks`: by hypothesis, indices
/// into the distinct tracks.
std::vector<RankedChild> rankChildren(const std::vector<TrackIndices>& tracks,
                                      const std::vector<double>& log_weights,
                                      const AssociationIndex& index, const RankingLimits& limits);

}  // namespace perception
