#pragma once
#include <algorithm>
#include <memory>

#include "libperception/core/Frames.h"
#include "libperception/core/Time.h"
#include "libperception/measurement/frames/AirClouds.h"
#include "libperception/measurement/frames/WakeMap.h"

namespace perception {

/// Probabilities [0, 1] that something makes phantoms at a place.
struct CausesHere {
  double weather = 0;  ///< the air is not clear, everywhere
  double cloud = 0;    ///< the lidar sees a cloud there
  double wake = 0;     ///< a vehicle has just left the place
  double came = 0;     ///< the same, or it must have come by before it was first seen
  double spray = 0;    ///< vehicles throw up spray, everywhere; no cause for likelier()
  double likelier() const { return std::max({weather, cloud, came}); }
  /// Whether likely a cloud hangs there that is no weather, whose returns may lie as close together
  /// as a wall's.
  bool inCloud() const { return std::max(cloud * (1 - weather), came) > 0.5; }
};

/// What may make phantoms of a lidar's returns at the instant of a scan, as the sensors themselves
/// show it: no return is doubted beyond the probability of such a cause (method.md 8.4).
struct PhantomCauses {
  double weather = 0;                       ///< [0, 1] P(the air is not clear), everywhere
  std::shared_ptr<const AirClouds> clouds;  ///< that the lidar sees near by; null: none
  std::shared_ptr<const WakeMap> wakes;     ///< of tracked vehicles; null: none
  /// [0, 1] P(vehicles throw up spray), by what their wakes showed lately. Vehicles that are not
  /// tracked do so, too, but this is no cause for the safety grid: any() and likelier() leave it
  /// out.
  double spray = 0;

  /// False: every return counts in full.
  bool any() const;
  /// At a place [m, world]. `likeliest_alone`: only its likelier() is needed.
  CausesHere at(const Vector2& place, Stamp now, bool likeliest_alone = false) const;
};

}  // namespace perception
