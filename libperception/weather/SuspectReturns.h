#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "libperception/weather/Neighbours.h"
#include "libperception/weather/TrustParams.h"

namespace perception {

/// A return that may be a phantom, and how it looks.
struct SuspectReturn {
  std::uint32_t index = 0;                       ///< in the cloud
  std::array<float, kTrustFeatures> features{};  ///< [m], counts or shares, as TrustFeature
  float first = 0;   ///< [log-odds] of the first pass, with intensity, without weather
  float second = 0;  ///< [log-odds] of the second pass, without weather
};

/// The suspects of a scan, in its order: an array a number, so that loops over them are short. The
/// arrays keep their memory: only the first `count` are of this scan.
struct SuspectReturns {
  std::size_t count = 0;
  std::vector<std::uint32_t> index;
  std::vector<NeighbourCounts> neighbours;
  std::vector<float> range, height;  ///< [m]
  std::vector<float> geometry;       ///< [log-odds] without intensity and weather
  std::vector<float> first, second;  ///< [log-odds]
  std::vector<float> company;        ///< as TrustFeature::kCompany; of those that were asked

  /// Room for that many.
  void reserve(std::size_t most) {
    if (most <= index.size()) return;
    index.resize(most), neighbours.resize(most);
    for (auto* numbers : {&range, &height, &geometry, &first, &second, &company})
      numbers->resize(most);
  }
  SuspectReturn at(std::size_t s) const {
    const auto share = [](std::uint32_t part, std::uint32_t whole) {
      return whole > 0 ? static_cast<float>(part) / static_cast<float>(whole) : 1.0F;
    };
    const NeighbourCounts n = neighbours[s];
    return {index[s],
            {range[s], static_cast<float>(n.tight()), static_cast<float>(n.wide()),
             share(n.beyond(), n.filled()), height[s], company[s]},
            first[s],
            second[s]};
  }
  std::size_t memoryBytes() const { return 8 * sizeof(float) * index.capacity(); }
};

}  // namespace perception
