#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "libperception/weather/HeightAboveGround.h"
#include "libperception/weather/trust/IntensityLaw.h"
#include "libperception/weather/trust/NeighborCounts.h"
#include "libperception/weather/trust/RangeImage.h"
#include "libperception/weather/trust/SurroundingCubes.h"
#include "libperception/weather/trust/TrustParams.h"

namespace perception {

/// A return that may be a phantom, and its features.
struct SuspectReturn {
  std::uint32_t index = 0;                       ///< in the cloud
  std::array<float, kTrustFeatures> features{};  ///< [m], counts or shares, as TrustFeature
  float first = 0;   ///< [log-odds] of the first pass, with intensity, without weather
  float second = 0;  ///< [log-odds] of the second pass, without weather
};

/// The suspects of a scan in its order, as a structure of arrays; initially all near returns. The
/// arrays keep their memory: only the first `count` elements are valid.
struct SuspectReturns {
  std::size_t count = 0;
  std::vector<std::uint32_t> index;  ///< in the cloud
  std::vector<std::uint32_t> pixel;  ///< of the range image; not updated by clearSurfaces()
  std::vector<std::uint32_t>
      cube;  ///< of SurroundingCubes; the bits above kBinShift hold the intensity bin
  std::vector<std::uint32_t> corner;     ///< of SurroundingCubes
  std::vector<std::uint32_t> neighbors;  ///< bits of NeighborCounts
  std::vector<float> range, height;      ///< [m]
  std::vector<float> geometry;           ///< [log-odds] without intensity and weather
  std::vector<float> first, second;      ///< [log-odds]
  std::vector<float>
      surroundings;  ///< as TrustFeature::kSurroundings; of suspects in the second pass

  static constexpr int kBinShift = 28;
  std::uint32_t binOf(std::size_t s) const { return cube[s] >> kBinShift; }
  std::uint32_t cubeOf(std::size_t s) const { return cube[s] & ((1U << kBinShift) - 1); }

  /// Appends the returns of a block that are within `far` [m], with the `bins` of their
  /// intensities, and counts them in their cubes.
  void add(const LidarCloud& cloud, const RangeImage::Block& block, const std::uint32_t* bins,
           const HeightAboveGround& height_above, float far, SurroundingCubes& cubes);
  /// Removes returns with at least `surface` of the eight nearest pixels on the same surface.
  void clearSurfaces(std::uint32_t surface);
  /// Resizes the arrays of results to `count`.
  void makeRoomForResults();
  SuspectReturn at(std::size_t s) const;
  std::size_t memoryBytes() const { return 11 * sizeof(float) * index.capacity(); }

 private:
  void makeRoom(std::size_t more);
};

}  // namespace perception
