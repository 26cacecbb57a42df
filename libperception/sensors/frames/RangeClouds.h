#pragma once
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationRotatingScan.h>

#include <cstdint>
#include <optional>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// All of these add the number of returns dropped for a range of 0 or below to `no_range`.

/// A planar scan without the beams marked invalid. Intensities are not scaled.
LidarCloud planarCloud(const mrpt::obs::CObservation2DRangeScan& scan, std::uint64_t& no_range);

/// The range image of a 3D camera, or the points of a scanner that stores points (Ibeo LUX): x
/// forward, y left. Labels named object, rain, ground or dirt are kept. External data are loaded.
/// Empty when they are missing, when arrays are inconsistent or without points.
std::optional<LidarCloud> rangeImageCloud(const mrpt::obs::CObservation3DRangeScan& scan,
                                          std::uint64_t& no_range);

/// A range image by rows (beams) and columns (azimuths). The class has no elevations: those of the
/// named sensor model are used. MRPT stores Velodyne's clockwise azimuths as counter-clockwise;
/// this is corrected. Empty for unknown models.
std::optional<LidarCloud> rotatingCloud(const mrpt::obs::CObservationRotatingScan& scan,
                                        std::uint64_t& no_range);

}  // namespace perception
