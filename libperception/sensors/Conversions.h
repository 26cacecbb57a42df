#pragma once
#include <mrpt/poses/CPose3D.h>
#include <mrpt/system/datetime.h>

#include <optional>

#include "libperception/core/Frames.h"
#include "libperception/core/Time.h"

namespace perception {

Pose3 toPose3(const mrpt::poses::CPose3D& pose);
mrpt::poses::CPose3D toMrpt(const Pose3& pose);

/// MRPT counts 100 ns since 1601, we count ns since 1970: exact. Empty for INVALID_TIMESTAMP and
/// for stamps that no clock of ours writes (1970 or before, 2106 or later).
std::optional<Stamp> toStamp(const mrpt::system::TTimeStamp& stamp);
/// Exact for whole multiples of 100 ns, otherwise the multiple before.
mrpt::system::TTimeStamp fromStamp(Stamp stamp);

}  // namespace perception
