#pragma once
#include <string>
#include <vector>

#include "libperception/evaluation/tables/StudyReport.h"

namespace CLI {
class App;
}

namespace perception {

/// perception-study obstacles.
struct ObstaclesOptions {
  std::string config = "ini/kitti.ini";
  std::vector<std::string> settings;           ///< section.key=value
  std::vector<int> beams = {16, 32, 64, 128};  ///< of the lidars
  std::vector<double> speeds = {5, 10, 20};    ///< [m/s]
  std::vector<std::string> weather = {"clear", "rain_10", "snow_2.5", "fog_150",
                                      "spray"};  ///< "clear", else an INI beside the config
  std::vector<std::string> intensity = {"given", "none"};
  std::vector<std::string> ways = {"forward"};
  std::vector<std::string> shapes;  ///< parts of names or kinds; empty: all
  int stride = 1;                   ///< every n-th of these shapes
  double sector = 90;               ///< [deg] of the lidar's view
  double lead = 2;                  ///< [s] of driving before the shape is near enough to stop
};
void declareObstacles(CLI::App& cli, ObstaclesOptions& options);

/// When shapes that no detector was taught are first called for, by the run's own advice and by
/// plain Euclidean clusters, against the stopping distance and the first ten returns; everything
/// simulated. Throws Error (kUsage) where no shape is left.
StudyReport obstaclesStudy(const ObstaclesOptions& options, unsigned long long seed);

}  // namespace perception
