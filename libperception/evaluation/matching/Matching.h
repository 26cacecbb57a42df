#pragma once
#include <vector>

#include "libperception/core/Frames.h"

namespace perception {

/// Matching of estimates to truth objects.
enum class Pairing {
  kClosest,   ///< the closest estimate of each truth; one estimate may match several truths
              ///< [radecki2016]
  kOneToOne,  ///< each estimate matches at most one truth: most pairs, then smallest sum of
              ///< distances
};
inline constexpr int kPairings = 2;

/// For each truth the index of its estimate or -1. Centers on the ground [m], both in the same
/// frame; pairs are at most `tolerance` [m] apart (2 m in [radecki2016]). Of equally close
/// estimates the first is taken.
std::vector<int> match(const std::vector<Vector2>& truth, const std::vector<Vector2>& estimates,
                       double tolerance, Pairing pairing);

}  // namespace perception
