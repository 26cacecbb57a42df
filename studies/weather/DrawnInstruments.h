#pragma once
#include <cstdint>
#include <vector>

namespace perception {

/// A lidar of the second generator (ParticleReceiver).
struct DrawnInstrument {
  double divergence_mrad = 0;  ///< full angle of its beam
  double flake_reflectivity = 0;
};

/// `count` lidars whose divergence and flakes' reflectivity are known to a tenth: each is 3 mrad or
/// 0.9 times a log-normal factor that is within 1.1 in 90 % [assumed, as PrecipitationRate's limits
/// do]. A Latin hypercube: each of `count` equally likely intervals holds one lidar, so that few of
/// them show the whole spread.
std::vector<DrawnInstrument> drawnInstruments(std::size_t count, std::uint64_t seed);

}  // namespace perception
