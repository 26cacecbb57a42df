#pragma once
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "libperception/importers/ImportText.h"
#include "libperception/importers/positions/ImportGps.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Fixes with increasing stamps. After a backward step of the receiver's clock, fixes are dropped
/// until it steps forward again. `dropped` is increased by their number; duplicates are not
/// counted.
std::vector<GpsFix> steadyFixes(const std::vector<GpsFix>& fixes, std::size_t& dropped);

/// A lidar scan in the vehicle's frame.
using StampedScan = std::pair<Stamp, std::vector<Vector3>>;

/// Clock offset [s] to be added to the stamps of the poses: minimizes the number of cells that the
/// scans occupy in the world frame. Searched within `reach` [s] of `start`, where the poses cover
/// all scans. Empty if undetermined (too few scans or poses, or the minimum is at the border of the
/// search).
std::optional<double> clockShift(const std::vector<StampedPose>& poses,
                                 const std::vector<StampedScan>& scans, double start,
                                 double reach = 5);

/// The pose at a stamp, interpolated; empty outside of the poses.
std::optional<Pose3> poseBetween(const std::vector<StampedPose>& poses, Stamp stamp);

}  // namespace perception
