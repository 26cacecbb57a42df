#pragma once
#include "libperception/pipeline/PipelineSetup.h"
#include "studies/obstacles/ObstacleDrive.h"
#include "studies/obstacles/ObstacleVerdict.h"

namespace perception {

/// Runs a drive, until all is said or the vehicle is at the shape, through the whole chain of
/// `setup`: its front end, trust, tracker and safety monitor. `intensity`: whether the lidar gives
/// any; without, it reports 0 for every return.
ObstacleVerdict runDrive(ObstacleDrive& drive, const ObstacleDriveParams& params,
                         const PipelineSetup& setup, bool intensity);

/// Label of the first lidar in use. Throws ConfigError where there is none, or no grid.
std::string lidarInUse(const PipelineSetup& setup);

}  // namespace perception
