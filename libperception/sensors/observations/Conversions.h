#pragma once
#include <mrpt/poses/CPose3D.h>
#include <mrpt/system/datetime.h>

#include <optional>

#include "libperception/core/Frames.h"
#include "libperception/core/Time.h"

namespace perception {

Pose3 toPose3(const mrpt::poses::CPose3D& pose);
mrpt::poses::CPose3D toMrpt(const Pose3& pose);

/// Exact conversion from 100 ns since 1601 to ns since 1970. Empty for INVALID_TIMESTAMP and
/// outside of 1970 to 2106.
std::optional<Stamp> toStamp(const mrpt::system::TTimeStamp& stamp);
/// Rounded down to a multiple of 100 ns.
mrpt::system::TTimeStamp fromStamp(Stamp stamp);

}  // namespace perception
