#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "libperception/core/math/Angle.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

inline constexpr std::uint16_t kSnowLabel = 110;  ///< class of falling snow in point labels

/// What two lidars have in common: directions ahead and ranges that both return, one return for
/// each cell of directions, so that neither's spacing of beams counts.
struct SnowSector {
  double azimuth = radians(40);                       ///< [rad] to both sides
  double lowest = radians(-8), highest = radians(2);  ///< [rad] elevation
  double nearest = 3, farthest = 20;                  ///< [m] of snow
  double across = radians(0.2), up = radians(0.4);    ///< [rad] of a cell
};

/// Returns of one scan in the sector, snow and surfaces.
struct SnowScan {
  std::vector<Vector3> places;    ///< [m] sensor frame
  std::vector<double> intensity;  ///< any unit: ranks count
  std::vector<bool> snow;
  double height = 0;  ///< [m] of the sensor above the ground
};

/// The return nearest to a cell's middle stands for it; of several along one beam, the first.
SnowScan comparableScan(const LidarCloud& cloud, const std::vector<std::uint16_t>& labels,
                        double height, const SnowSector& sector);

inline constexpr std::size_t kSnowFeatures = 10;
using SnowFeatures = std::array<float, kSnowFeatures>;
/// Names of the features, fixed before any model was compared by them.
inline constexpr std::array<const char*, kSnowFeatures> kSnowFeatureNames = {
    "range",
    "rank of the intensity in the scan",
    "1st neighbor / range",
    "3rd neighbor / range",
    "5th neighbor / range",
    "1st neighbor of snow / range",
    "3rd neighbor of snow / range",
    "5th neighbor of snow / range",
    "snow within 1 deg and 0.3 m",
    "height above ground"};

/// Features of all snow returns within the sector's ranges.
std::vector<SnowFeatures> snowFeatures(const SnowScan& scan, const SnowSector& sector);

}  // namespace perception
