#include "libperception/simulation/lidar/LidarSurface.h"

#include <array>
#include <cmath>

namespace perception {
namespace {

constexpr std::array<LidarSurface, 10> kSurfaces = {{{.17, .3, 0},    // road
                                                     {.45, 1, .05},   // paint
                                                     {.10, 1, .75},   // glass
                                                     {.06, .6, 0},    // tire
                                                     {.35, .6, 0},    // cloth
                                                     {.50, .8, 0},    // skin
                                                     {.50, 1, .05},   // metal
                                                     {.40, .8, 0},    // wall
                                                     {.35, .5, 0},    // leaf
                                                     {.35, .3, 0}}};  // grass

}  // namespace

const LidarSurface& lidarSurface(Material material) {
  return kSurfaces[static_cast<std::size_t>(material)];
}

double lidarReflectivity(const BeamHit& hit) {
  const LidarSurface& surface = lidarSurface(hit.material);
  return surface.reflectivity * std::pow(static_cast<double>(hit.cos_incidence), surface.grazing);
}

}  // namespace perception
