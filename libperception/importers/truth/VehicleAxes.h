#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/importers/ImportText.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

// What data sets do not tell about the place of a lidar on its vehicle, found from their data.

/// [m] above the road: the height at which most returns within 4 to 20 m lie, the median of up to
/// 20 scans throughout the drive. Empty: there are too few returns below the lidar.
std::optional<double> heightAboveRoad(const std::vector<FrameFile>& scans,
                                      const std::function<LidarCloud(const std::string&)>& read);

/// The direction in which a sensor travels, in its own frame, by steps of its poses of half a meter
/// or more: the mean, of length 1 where it is always the same and shorter where it is not. Empty:
/// there is no such step.
std::optional<Vector3> travelDirection(const std::vector<StampedPose>& poses);

/// Intensities of a set that does not say their scale: 1 where the first scans have none above 1,
/// else 255.
double intensityScaleOf(const std::vector<FrameFile>& scans,
                        const std::function<LidarCloud(const std::string&)>& read);

}  // namespace perception
