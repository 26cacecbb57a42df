#pragma once
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationRotatingScan.h>

#include <cstdint>
#include <optional>

#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// Returns left out because their range is 0 or negative is added to `no_range` in all of these.

/// A planar scan, beams that are marked invalid left out. Intensities as they are.
LidarCloud planarCloud(const mrpt::obs::CObservation2DRangeScan& scan, std::uint64_t& no_range);

/// A range camera's image, or the points of a scanner that stores points (Ibeo LUX): x forward, y
/// left. Labels named object, rain, ground or dirt are kept. Data outside of the log are loaded.
/// Empty when they are not there, when arrays contradict each other or when there is nothing.
std::optional<LidarCloud> rangeImageCloud(const mrpt::obs::CObservation3DRangeScan& scan,
                                          std::uint64_t& no_range);

/// A range image by rows (beams) and columns (azimuths). The class holds no elevations: those of
/// the model that it names are taken. MRPT writes Velodyne's azimuths, which turn clockwise, as if
/// they turned to the left; they are read as what they are. Empty for unknown models.
std::optional<LidarCloud> rotatingCloud(const mrpt::obs::CObservationRotatingScan& scan,
                                        std::uint64_t& no_range);

}  // namespace perception
