#pragma once
#include <vector>

#include "libperception/detectors/HogFeatures.h"
#include "libperception/detectors/dpm/DpmBank.h"

namespace perception {

/// What one group needs of one level, and what it gets.
struct DpmGroupSearch {
  Span lattice_x, lattice_y;        ///< [root cells] of parts' places, halved
  Span patch_columns, patch_rows;   ///< of the level's patches
  std::vector<AlignedFloats> best;  ///< per parity: displaced responses, lattice by 2 * lanes
};

/// What one target needs of one level.
struct DpmSearch {
  std::vector<Span> x, y;  ///< [root cells] per component: of the root's corner
  std::vector<DpmGroupSearch> groups;
};

/// A scale of the pyramid.
struct DpmLevel {
  int width = 0, height = 0;        ///< [px]
  double scale_x = 1, scale_y = 1;  ///< of the image
  int cells_x = 0, cells_y = 0;     ///< of 8 px
  int parts_level = -1;             ///< whose cells the parts see; -1: cells of half the side here
  std::vector<DpmSearch> searches;  ///< per target
  Span root_x, root_y;              ///< [cells] that roots read
  int patch_x0 = 0, patch_y0 = 0, patches_x = 0, patches_y = 0;
  Span part_x, part_y;  ///< [part cells] that patches read
  FeatureMap roots, parts;
  const FeatureMap* part_map = nullptr;
  AlignedFloats spectra;  ///< kDpmSpectrumStride a patch; not set where nothing is searched
};

/// Patches lie so far apart that equal frequencies of several do not fall on the same lines of the
/// cache (sizes alone are multiples of 2048 bytes).
constexpr std::size_t kDpmSpectrumStride = kSpectrum + 112;

/// Which places each component may take at each scale of an image, and what that needs.
std::vector<DpmLevel> planPyramid(const DpmBank& bank, int width, int height,
                                  const SearchRegion& region);
/// Features and spectra of what was planned.
void buildPyramid(const DpmBank& bank, const Raster& image, std::vector<DpmLevel>& levels);

}  // namespace perception
