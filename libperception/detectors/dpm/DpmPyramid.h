#pragma once
#include <vector>

#include "libperception/detectors/HogFeatures.h"
#include "libperception/detectors/dpm/DpmBank.h"

namespace perception {

/// Region of one group at one level, and its responses.
struct DpmGroupSearch {
  Span lattice_x, lattice_y;        ///< [root cells] of part positions, halved
  Span patch_columns, patch_rows;   ///< patches of the level
  std::vector<AlignedFloats> best;  ///< per parity: displaced responses, lattice by 2 * lanes
};

/// Region of one target at one level.
struct DpmSearch {
  std::vector<Span> x, y;  ///< [root cells] per component: of the root's corner
  std::vector<DpmGroupSearch> groups;
};

/// A scale of the pyramid.
struct DpmLevel {
  int width = 0, height = 0;        ///< [px]
  double scale_x = 1, scale_y = 1;  ///< of the image
  int cells_x = 0, cells_y = 0;     ///< of 8 px
  int parts_level = -1;             ///< level of the parts' cells; -1: cells of half the side here
  std::vector<DpmSearch> searches;  ///< per target
  Span root_x, root_y;              ///< [cells] read by roots
  int patch_x0 = 0, patch_y0 = 0, patches_x = 0, patches_y = 0;
  Span part_x, part_y;  ///< [part cells] read by patches
  FeatureMap roots, parts;
  const FeatureMap* part_map = nullptr;
  AlignedFloats spectra;  ///< kDpmSpectrumStride per patch; undefined where nothing is searched
};

/// Stride between spectra, padded so that equal frequencies of several patches do not map to the
/// same cache lines (the size alone is a multiple of 2048 bytes).
constexpr std::size_t kDpmSpectrumStride = kSpectrum + 112;

/// Plans the levels of an image: allowed positions of each component and the features they need.
std::vector<DpmLevel> planPyramid(const DpmBank& bank, int width, int height,
                                  const SearchRegion& region);
/// Computes features and spectra of the planned levels.
void buildPyramid(const DpmBank& bank, const Raster& image, std::vector<DpmLevel>& levels);

}  // namespace perception
