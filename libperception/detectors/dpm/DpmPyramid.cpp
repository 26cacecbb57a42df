#include "libperception/detectors/dpm/DpmPyramid.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace perception {
namespace {

constexpr int kSmallestImage = 5;  // [cells] voc-release: the pyramid's last level

// ---- search regions

/// Corners at which at most the share `outside` of a component lies beyond the image.
Span cornersOf(int size, int cells, double outside) {
  const int beyond = static_cast<int>(std::ceil(outside * size));
  return {-beyond, cells + beyond - size + 1};
}

void planSearch(const DpmBank& bank, DpmLevel& level, std::size_t target,
                const SearchRegion& region) {
  const DpmTarget& t = bank.targets[target];
  const double pixel = bank.cell / level.scale_y;
  DpmSearch search;
  for (const DpmComponent& c : t.model.components) {
    Span x = cornersOf(c.root.width, level.cells_x, region.continued ? 0 : bank.options.outside);
    Span y = cornersOf(c.root.height, level.cells_y, bank.options.outside);
    if (region.ground) {
      const auto bottoms = region.ground->bottoms(c.height * pixel, t.low, t.high);
      y = y.within({static_cast<int>(std::ceil(bottoms.begin / pixel)) - c.height,
                    static_cast<int>(std::floor(bottoms.end / pixel)) - c.height + 1});
    }
    if (x.empty() || y.empty()) x = y = {};
    search.x.push_back(x);
    search.y.push_back(y);
    if (x.empty()) continue;
    level.root_x = level.root_x.with({x.begin, x.end - 1 + c.root.width});
    level.root_y = level.root_y.with({y.begin, y.end - 1 + c.root.height});
  }
  for (const DpmBank::Group& group : bank.groups[target]) {
    DpmGroupSearch g;
    for (const DpmBank::Lane& lane : group.lanes) {
      const auto k = static_cast<std::size_t>(lane.component);
      if (search.x[k].empty()) continue;
      const DpmPart& part = t.model.components[k].parts[static_cast<std::size_t>(lane.part)];
      const int dx = DpmBank::halfOf(part.anchor_x), dy = DpmBank::halfOf(part.anchor_y);
      g.lattice_x = g.lattice_x.with({search.x[k].begin + dx, search.x[k].end + dx});
      g.lattice_y = g.lattice_y.with({search.y[k].begin + dy, search.y[k].end + dy});
    }
    search.groups.push_back(std::move(g));
  }
  level.searches.push_back(std::move(search));
}

void planPatches(const DpmBank& bank, DpmLevel& level) {
  // [part cells] of part positions, displacements and odd anchors included.
  const auto placesOf = [&](const Span& lattice) {
    return lattice.empty() ? Span{}
                           : Span{2 * lattice.begin - bank.options.window,
                                  2 * (lattice.end - 1) + 1 + bank.options.window + 1};
  };
  Span x, y;
  for (const DpmSearch& s : level.searches) {
    for (const DpmGroupSearch& g : s.groups) {
      x = x.with(placesOf(g.lattice_x));
      y = y.with(placesOf(g.lattice_y));
    }
  }
  if (x.empty()) return;
  level.patch_x0 = x.begin;
  level.patch_y0 = y.begin;
  level.patches_x = (x.size() + bank.valid - 1) / bank.valid;
  level.patches_y = (y.size() + bank.valid - 1) / bank.valid;
  const auto patchesOf = [&](const Span& places, int origin) {
    return places.empty() ? Span{}
                          : Span{(places.begin - origin) / bank.valid,
                                 (places.end - 1 - origin) / bank.valid + 1};
  };
  for (DpmSearch& s : level.searches) {
    for (DpmGroupSearch& g : s.groups) {
      g.patch_columns = patchesOf(placesOf(g.lattice_x), level.patch_x0);
      g.patch_rows = patchesOf(placesOf(g.lattice_y), level.patch_y0);
    }
  }
  level.part_x = {x.begin, x.begin + level.patches_x * bank.valid + kPatch - bank.valid};
  level.part_y = {y.begin, y.begin + level.patches_y * bank.valid + kPatch - bank.valid};
}

// ---- features

void buildFeatures(const DpmBank& bank, const Raster& image, std::vector<DpmLevel>& levels) {
  std::vector<PlanarImage> octaves;
  octaves.push_back(planarImage(image));
  const int interval = bank.options.levels_per_octave;
  const int first = static_cast<int>(std::lround(std::log2(bank.options.enlarge) * interval));
  for (int k = 0; k < static_cast<int>(levels.size()); ++k) {
    while ((k - first) / interval > static_cast<int>(octaves.size()) - 1)
      octaves.push_back(halved(octaves.back()));
  }
  tbb::parallel_for(std::size_t{0}, levels.size(), [&](std::size_t k) {
    DpmLevel& level = levels[k];
    std::vector<FeatureRequest> requests;
    // For the roots of this level and the parts of the level an octave above.
    FeatureRequest whole{bank.cell, level.root_x, level.root_y};
    for (const DpmLevel& other : levels) {
      if (other.parts_level != static_cast<int>(k) || other.part_x.empty()) continue;
      whole.x = whole.x.with(other.part_x);
      whole.y = whole.y.with(other.part_y);
    }
    const bool has_whole = !whole.x.empty() && !whole.y.empty();
    if (has_whole) requests.push_back(whole);
    const bool has_half = level.parts_level < 0 && !level.part_x.empty();
    if (has_half) requests.push_back({bank.cell / 2, level.part_x, level.part_y});
    if (requests.empty()) return;
    Span rows;
    for (const auto& r : requests)
      rows = rows.with(
          pixelRows(r.y.within({1, cellsAcross(level.height, r.side) - 1}), r.side, level.height));
    const int octave = std::max(0, (static_cast<int>(k) - first) / interval);
    const PlanarImage scaled =
        resampled(octaves[static_cast<std::size_t>(octave)], level.width, level.height,
                  rows.within({0, level.height}), bank.kernels);
    auto maps = hogFeatures(scaled, requests, bank.kernels);
    if (has_half) level.parts = std::move(maps.back());
    if (has_whole) level.roots = std::move(maps.front());
  });
  for (DpmLevel& level : levels) {
    level.part_map = level.parts_level < 0
                         ? &level.parts
                         : &levels[static_cast<std::size_t>(level.parts_level)].roots;
  }
}

/// Whether any group uses that patch.
bool wanted(const DpmLevel& level, int column, int row) {
  const auto holds = [](const Span& span, int i) { return i >= span.begin && i < span.end; };
  for (const DpmSearch& s : level.searches) {
    for (const DpmGroupSearch& g : s.groups) {
      if (holds(g.patch_columns, column) && holds(g.patch_rows, row)) return true;
    }
  }
  return false;
}

void transform(const DpmBank& bank, std::vector<DpmLevel>& levels) {
  tbb::parallel_for(std::size_t{0}, levels.size(), [&](std::size_t k) {
    DpmLevel& level = levels[k];
    level.spectra = AlignedFloats(static_cast<std::size_t>(level.patches_x * level.patches_y) *
                                  kDpmSpectrumStride);
    tbb::parallel_for(0, level.patches_y, [&](int row) {
      for (int column = 0; column < level.patches_x; ++column) {
        if (!wanted(level, column, row)) continue;
        const auto patch = static_cast<std::size_t>(row * level.patches_x + column);
        bank.kernels.forward(level.part_map->cell(level.patch_x0 + column * bank.valid,
                                                  level.patch_y0 + row * bank.valid),
                             level.part_map->rowStride(),
                             level.spectra.data() + patch * kDpmSpectrumStride);
      }
    });
  });
}

}  // namespace

std::vector<DpmLevel> planPyramid(const DpmBank& bank, int width, int height,
                                  const SearchRegion& region) {
  std::vector<DpmLevel> levels;
  const int interval = bank.options.levels_per_octave;
  for (int k = 0;; ++k) {
    const double scale = bank.options.enlarge * std::pow(2.0, -static_cast<double>(k) / interval);
    DpmLevel level;
    level.width = static_cast<int>(std::lround(width * scale));
    level.height = static_cast<int>(std::lround(height * scale));
    if (std::min(level.width, level.height) < kSmallestImage * bank.cell) break;
    level.scale_x = static_cast<double>(level.width) / width;
    level.scale_y = static_cast<double>(level.height) / height;
    level.cells_x = cellsAcross(level.width, bank.cell);
    level.cells_y = cellsAcross(level.height, bank.cell);
    level.parts_level = k - interval;
    for (std::size_t t = 0; t < bank.targets.size(); ++t) planSearch(bank, level, t, region);
    planPatches(bank, level);
    levels.push_back(std::move(level));
  }
  return levels;
}

void buildPyramid(const DpmBank& bank, const Raster& image, std::vector<DpmLevel>& levels) {
  buildFeatures(bank, image, levels);
  transform(bank, levels);
}

}  // namespace perception
