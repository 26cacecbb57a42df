#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libperception/calibration/clusters/TreeTraining.h"

namespace perception {

/// The samples' values by feature as numbers of bins. Bin b holds values up to thresholds[b] that
/// are in no bin before, the last bin all others.
struct BinnedSamples {
  std::array<std::vector<float>, kFeatures> thresholds;
  std::vector<std::uint8_t> bins;  ///< by feature, then by sample
  std::size_t count = 0;

  /// At most `most` bins for a feature, up to 256.
  BinnedSamples(const std::vector<TrainingSample>& samples, std::size_t most);
  const std::uint8_t* column(std::size_t feature) const { return &bins[feature * count]; }

 private:
  void bin(const std::vector<TrainingSample>& samples, std::size_t f, std::size_t most);
};

}  // namespace perception
