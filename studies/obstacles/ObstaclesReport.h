#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "libperception/evaluation/tables/StudyReport.h"
#include "studies/obstacles/ObstacleDrive.h"
#include "studies/obstacles/ObstacleVerdict.h"
#include "studies/obstacles/ObstaclesStudy.h"

namespace perception {

/// A drive with and without intensities.
struct DriveCase {
  ObstacleDriveParams params;
  std::string weather;
  std::vector<ObstacleVerdict> verdicts;  // one for each of ObstaclesOptions::intensity
};

/// Tables, plot and remarks of the obstacles study about its drives towards `shapes` shapes.
StudyReport obstaclesReport(const std::vector<DriveCase>& cases, const ObstaclesOptions& options,
                            std::size_t shapes);

}  // namespace perception
