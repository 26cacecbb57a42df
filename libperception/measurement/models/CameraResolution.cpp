#include "libperception/measurement/models/CameraResolution.h"

namespace perception {

const std::vector<CameraResolution>& cameraResolutions() {
  static const std::vector<CameraResolution> rows = {{"1k", 1024, 512, 7, 5, 0.04},
                                                     {"2k", 2048, 1024, 15, 10, 0.12},
                                                     {"4k", 4096, 2048, 32, 20, 0.82},
                                                     {"8k", 8000, 4000, 70, 40, 3.1}};
  return rows;
}

std::vector<std::string> cameraResolutionNames() {
  std::vector<std::string> names;
  for (const CameraResolution& row : cameraResolutions()) names.emplace_back(row.name);
  return names;
}

}  // namespace perception
