#pragma once
#include <cstdint>
#include <vector>

#include "libperception/filter/associate/Association.h"

namespace perception {

/// How many associations the hypotheses of a scan are continued with.
struct RankingLimits {
  std::size_t children = 4;  ///< of one hypothesis at most
  std::size_t slots = 1;     ///< of all together at most
  double span = 14;          ///< none lighter than the best of all by more, in log weight
};

/// One likely association of one hypothesis.
struct RankedChild {
  std::size_t parent = 0;  ///< index of the hypothesis
  Association association;
  double log_weight = 0;  ///< that of the parent and of the association together
};

/// Pass 3 for all hypotheses at once: their likeliest associations, best first, with exact weights
/// (method.md 6). The scan falls into parts whose measurements share no candidates; hypotheses that
/// hold the same tracks in a part share its ranking, and what cannot be among the best `slots` of
/// all is never made. `tracks`: by hypothesis indices of its tracks into the distinct ones.
std::vector<RankedChild> rankChildren(const std::vector<TrackIndices>& tracks,
                                      const std::vector<double>& log_weights,
                                      const AssociationIndex& index, const RankingLimits& limits);

}  // namespace perception
