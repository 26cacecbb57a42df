#pragma once
#include <vector>

#include "libperception/core/Frames.h"

namespace perception {

/// How estimates are given to truth objects.
enum class Pairing {
  kClosest,   ///< each truth takes the closest estimate; one estimate may serve several truths (the
              ///< paper)
  kOneToOne,  ///< an estimate serves at most one truth: as many pairs as can be, then the least sum
              ///< of distances
};
inline constexpr int kPairings = 2;

/// For each truth the place of its estimate or -1. Centers on the ground [m], one frame for both; a
/// pair is at most `tolerance` [m] apart (2 m in [radecki2016]). Of equally close estimates the
/// first is taken.
std::vector<int> match(const std::vector<Vector2>& truth, const std::vector<Vector2>& estimates,
                       double tolerance, Pairing pairing);

}  // namespace perception
