#pragma once
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "libperception/importers/ImportGps.h"
#include "libperception/importers/ImportText.h"
#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// Fixes whose stamps go forward. A receiver's clock that steps back is wrong until it steps
/// forward again: what stands between goes, too. `dropped` is increased by their number; a fix that
/// is told twice is none.
std::vector<GpsFix> steadyFixes(const std::vector<GpsFix>& fixes, std::size_t& dropped);

/// A lidar scan in the vehicle's frame.
using StampedScan = std::pair<Stamp, std::vector<Vector3>>;

/// [s] to add to the poses' stamps so that the scans agree best: brought into the world they then
/// cover the fewest cells. Looked for within `reach` [s] of `start`, where the poses cover all
/// scans. Empty: they tell none (too few scans or poses, or the best lies at the end of what can be
/// looked at).
std::optional<double> clockShift(const std::vector<StampedPose>& poses,
                                 const std::vector<StampedScan>& scans, double start,
                                 double reach = 5);

/// The pose at an instant, between its neighbors; empty outside the poses.
std::optional<Pose3> poseBetween(const std::vector<StampedPose>& poses, Stamp stamp);

}  // namespace perception
