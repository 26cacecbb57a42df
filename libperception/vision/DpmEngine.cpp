#include "libperception/vision/DpmEngine.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "libperception/core/Error.h"
#include "libperception/vision/HogFeatures.h"
#include "libperception/vision/Suppression.h"
#include "libperception/vision/VisionSimd.h"

namespace perception {
namespace {

// Patches lie so far apart that equal frequencies of several do not fall on the same lines of the
// cache (sizes alone are multiples of 2048 bytes).
constexpr std::size_t kSpectrumStride = kSpectrum + 112;
constexpr std::size_t kProductGap = 272;
constexpr int kSmallestImage = 5;  // [cells] voc-release: the pyramid's last level

/// A part as one filter of a group.
struct Lane {
  int component = -1, part = -1;
  std::size_t parity = 0;  // of its anchor, a place in Group::parities
};

/// 2 * lanes filters that are convolved together.
struct Group {
  std::vector<Lane> lanes;
  std::vector<std::pair<int, int>> parities;  // of anchors' columns and rows that occur: 0 or 1
  AlignedFloats weights;                      // see VisionKernels::products
  AlignedFloats costs_x, costs_y;             // (2 window + 1) x 2 lanes
};

/// floor(a / 2), for negative numbers too.
int halfOf(int a) { return a >= 0 ? a / 2 : -((1 - a) / 2); }
int parityOf(int a) { return a & 1; }

/// A target with its filters as the kernels want them.
struct Compiled {
  std::vector<Group> groups;
};

/// What one group needs of one level, and what it gets.
struct GroupSearch {
  Span lattice_x, lattice_y;        // [root cells] of parts' places, halved
  Span patch_columns, patch_rows;   // of the level's patches
  std::vector<AlignedFloats> best;  // per parity: displaced responses, lattice by 2 * lanes
};

/// What one target needs of one level.
struct Search {
  std::vector<Span> x, y;  // [root cells] per component: of the root's corner
  std::vector<GroupSearch> groups;
};

/// A scale of the pyramid.
struct Level {
  int width = 0, height = 0;        // [px]
  double scale_x = 1, scale_y = 1;  // of the image
  int cells_x = 0, cells_y = 0;     // of 8 px
  int parts_level = -1;             // whose cells the parts see; -1: cells of half the side here
  std::vector<Search> searches;     // per target
  Span root_x, root_y;              // [cells] that roots read
  int patch_x0 = 0, patch_y0 = 0, patches_x = 0, patches_y = 0;
  Span part_x, part_y;  // [part cells] that patches read
  FeatureMap roots, parts;
  const FeatureMap* part_map = nullptr;
  AlignedFloats spectra;  // kSpectrumStride a patch; not set where nobody looks
};

}  // namespace

struct DpmEngine::Bank {
  std::vector<DpmTarget> targets;
  DpmOptions options;
  const VisionKernels& kernels;
  std::vector<Compiled> compiled;
  int cell = 8;
  int valid = kPatch;  ///< [cells] side of a patch that is right for all parts

  Bank(std::vector<DpmTarget> t, DpmOptions o, SimdLevel level);
  void compile(const DpmTarget& target);
  Group makeGroup(const DpmTarget& target, const std::vector<Lane>& lanes) const;
  std::vector<Level> plan(int width, int height, const SearchRegion& region) const;
  void planSearch(Level& level, std::size_t target, const SearchRegion& region) const;
  void planPatches(Level& level) const;
  void buildFeatures(const Raster& image, std::vector<Level>& levels) const;
  void transform(std::vector<Level>& levels) const;
  void convolve(std::vector<Level>& levels) const;
  void convolveGroup(Level& level, std::size_t target, std::size_t group) const;
  std::vector<DpmDetection> collect(const Level& level, std::size_t target) const;
};

DpmEngine::Bank::Bank(std::vector<DpmTarget> t, DpmOptions o, SimdLevel level)
    : targets(std::move(t)), options(o), kernels(visionKernels(level)) {
  int largest = 1;
  for (const DpmTarget& target : targets) {
    cell = target.model.cell;
    if (cell != targets.front().model.cell)
      throw DataError(fmt::format("model {}: its cells have {} px, those of {} have {}",
                                  target.model.class_name, cell, targets.front().model.class_name,
                                  targets.front().model.cell));
    for (const DpmComponent& c : target.model.components) {
      for (const DpmPart& part : c.parts)
        largest = std::max({largest, part.filter.height, part.filter.width});
    }
  }
  valid = kPatch - largest + 1;
  if (valid < 4)
    throw DataError(
        fmt::format("a part of {} cells: at most {} are possible", largest, kPatch - 3));
  for (const DpmTarget& target : targets) compile(target);
}

void DpmEngine::Bank::compile(const DpmTarget& target) {
  Compiled c;
  std::vector<Lane> lanes;
  const auto& components = target.model.components;
  for (std::size_t k = 0; k < components.size(); ++k) {
    for (std::size_t p = 0; p < components[k].parts.size(); ++p)
      lanes.push_back({static_cast<int>(k), static_cast<int>(p), 0});
  }
  const auto size = static_cast<std::size_t>(2 * kernels.lanes);
  for (std::size_t i = 0; i < lanes.size(); i += size) {
    const auto end = std::min(lanes.size(), i + size);
    c.groups.push_back(makeGroup(target, {lanes.begin() + static_cast<std::ptrdiff_t>(i),
                                          lanes.begin() + static_cast<std::ptrdiff_t>(end)}));
  }
  compiled.push_back(std::move(c));
}

Group DpmEngine::Bank::makeGroup(const DpmTarget& target, const std::vector<Lane>& lanes) const {
  const int L = kernels.lanes, taps = 2 * options.window + 1;
  Group group;
  group.lanes = lanes;
  group.weights = AlignedFloats(static_cast<std::size_t>(kFrequencies * kFeatures * kWeights * L));
  group.costs_x = AlignedFloats(static_cast<std::size_t>(taps * 2 * L));
  group.costs_y = AlignedFloats(static_cast<std::size_t>(taps * 2 * L));
  std::fill_n(group.weights.data(), group.weights.size(), 0.F);
  std::fill_n(group.costs_x.data(), group.costs_x.size(), 0.F);
  std::fill_n(group.costs_y.data(), group.costs_y.size(), 0.F);
  constexpr std::size_t kCells = kPatch * kPatch;
  std::vector<float> patch(kCells * kFeatures), spectrum(kSpectrum);
  for (std::size_t lane = 0; lane < lanes.size(); ++lane) {
    const DpmPart& part = target.model.components[static_cast<std::size_t>(lanes[lane].component)]
                              .parts[static_cast<std::size_t>(lanes[lane].part)];
    const std::pair<int, int> parity{parityOf(part.anchor_x), parityOf(part.anchor_y)};
    const auto known = std::find(group.parities.begin(), group.parities.end(), parity);
    group.lanes[lane].parity = static_cast<std::size_t>(known - group.parities.begin());
    if (known == group.parities.end()) group.parities.push_back(parity);
    std::fill(patch.begin(), patch.end(), 0.F);
    const int row = part.filter.width * kFeatures;
    for (int y = 0; y < part.filter.height; ++y)
      std::copy_n(part.filter.weights.begin() + y * row, row,
                  patch.begin() + y * kPatch * kFeatures);
    kernels.forward(patch.data(), kPatch * kFeatures, spectrum.data());
    const int i = static_cast<int>(lane), half = i / L;
    for (int w = 0; w < kFrequencies; ++w) {
      for (int f = 0; f < kFeatures; ++f) {
        float* to = group.weights.data() + ((w * kFeatures + f) * kWeights + half * 3) * L + i % L;
        const float* from = spectrum.data() + w * 3 * kFeatures + f;
        // Conjugate: a correlation; scaled for the inverse transform.
        const float re = from[0] / static_cast<float>(kCells);
        const float im = -from[kFeatures] / static_cast<float>(kCells);
        to[0] = re;
        to[L] = im - re;
        to[2 * L] = im + re;
      }
    }
    for (int t = 0; t < taps; ++t) {
      const double d = options.window - t;  // anchor - place
      const double* a = part.deformation;
      group.costs_x[static_cast<std::size_t>(t * 2 * L + i)] =
          static_cast<float>(a[0] * d * d + a[1] * d);
      group.costs_y[static_cast<std::size_t>(t * 2 * L + i)] =
          static_cast<float>(a[2] * d * d + a[3] * d);
    }
  }
  return group;
}

// ---- what to look at

/// Corners at which a component of that size has at most its share outside the image.
Span cornersOf(int size, int cells, double outside) {
  const int beyond = static_cast<int>(std::ceil(outside * size));
  return {-beyond, cells + beyond - size + 1};
}

void DpmEngine::Bank::planSearch(Level& level, std::size_t target,
                                 const SearchRegion& region) const {
  const DpmTarget& t = targets[target];
  const double pixel = cell / level.scale_y;
  Search search;
  for (const DpmComponent& c : t.model.components) {
    Span x = cornersOf(c.root.width, level.cells_x, region.continued ? 0 : options.outside);
    Span y = cornersOf(c.root.height, level.cells_y, options.outside);
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
  for (const Group& group : compiled[target].groups) {
    GroupSearch g;
    for (const Lane& lane : group.lanes) {
      const auto k = static_cast<std::size_t>(lane.component);
      if (search.x[k].empty()) continue;
      const DpmPart& part = t.model.components[k].parts[static_cast<std::size_t>(lane.part)];
      const int dx = halfOf(part.anchor_x), dy = halfOf(part.anchor_y);
      g.lattice_x = g.lattice_x.with({search.x[k].begin + dx, search.x[k].end + dx});
      g.lattice_y = g.lattice_y.with({search.y[k].begin + dy, search.y[k].end + dy});
    }
    search.groups.push_back(std::move(g));
  }
  level.searches.push_back(std::move(search));
}

void DpmEngine::Bank::planPatches(Level& level) const {
  // [part cells] of parts' places, moves and odd anchors included.
  const auto placesOf = [&](const Span& lattice) {
    return lattice.empty() ? Span{}
                           : Span{2 * lattice.begin - options.window,
                                  2 * (lattice.end - 1) + 1 + options.window + 1};
  };
  Span x, y;
  for (const Search& s : level.searches) {
    for (const GroupSearch& g : s.groups) {
      x = x.with(placesOf(g.lattice_x));
      y = y.with(placesOf(g.lattice_y));
    }
  }
  if (x.empty()) return;
  level.patch_x0 = x.begin;
  level.patch_y0 = y.begin;
  level.patches_x = (x.size() + valid - 1) / valid;
  level.patches_y = (y.size() + valid - 1) / valid;
  const auto patchesOf = [&](const Span& places, int origin) {
    return places.empty()
               ? Span{}
               : Span{(places.begin - origin) / valid, (places.end - 1 - origin) / valid + 1};
  };
  for (Search& s : level.searches) {
    for (GroupSearch& g : s.groups) {
      g.patch_columns = patchesOf(placesOf(g.lattice_x), level.patch_x0);
      g.patch_rows = patchesOf(placesOf(g.lattice_y), level.patch_y0);
    }
  }
  level.part_x = {x.begin, x.begin + level.patches_x * valid + kPatch - valid};
  level.part_y = {y.begin, y.begin + level.patches_y * valid + kPatch - valid};
}

std::vector<Level> DpmEngine::Bank::plan(int width, int height, const SearchRegion& region) const {
  std::vector<Level> levels;
  const int interval = options.levels_per_octave;
  for (int k = 0;; ++k) {
    const double scale = options.enlarge * std::pow(2.0, -static_cast<double>(k) / interval);
    Level level;
    level.width = static_cast<int>(std::lround(width * scale));
    level.height = static_cast<int>(std::lround(height * scale));
    if (std::min(level.width, level.height) < kSmallestImage * cell) break;
    level.scale_x = static_cast<double>(level.width) / width;
    level.scale_y = static_cast<double>(level.height) / height;
    level.cells_x = cellsAcross(level.width, cell);
    level.cells_y = cellsAcross(level.height, cell);
    level.parts_level = k - interval;
    for (std::size_t t = 0; t < targets.size(); ++t) planSearch(level, t, region);
    planPatches(level);
    levels.push_back(std::move(level));
  }
  return levels;
}

// ---- features

void DpmEngine::Bank::buildFeatures(const Raster& image, std::vector<Level>& levels) const {
  std::vector<PlanarImage> octaves;
  octaves.push_back(planarImage(image));
  const int interval = options.levels_per_octave;
  const int first = static_cast<int>(std::lround(std::log2(options.enlarge) * interval));
  for (int k = 0; k < static_cast<int>(levels.size()); ++k) {
    while ((k - first) / interval > static_cast<int>(octaves.size()) - 1)
      octaves.push_back(halved(octaves.back()));
  }
  tbb::parallel_for(std::size_t{0}, levels.size(), [&](std::size_t k) {
    Level& level = levels[k];
    std::vector<FeatureRequest> requests;
    // As the roots of this level and as the parts of one an octave above.
    FeatureRequest whole{cell, level.root_x, level.root_y};
    for (const Level& other : levels) {
      if (other.parts_level != static_cast<int>(k) || other.part_x.empty()) continue;
      whole.x = whole.x.with(other.part_x);
      whole.y = whole.y.with(other.part_y);
    }
    const bool has_whole = !whole.x.empty() && !whole.y.empty();
    if (has_whole) requests.push_back(whole);
    const bool has_half = level.parts_level < 0 && !level.part_x.empty();
    if (has_half) requests.push_back({cell / 2, level.part_x, level.part_y});
    if (requests.empty()) return;
    Span rows;
    for (const auto& r : requests)
      rows = rows.with(
          pixelRows(r.y.within({1, cellsAcross(level.height, r.side) - 1}), r.side, level.height));
    const int octave = std::max(0, (static_cast<int>(k) - first) / interval);
    const PlanarImage scaled = resampled(octaves[static_cast<std::size_t>(octave)], level.width,
                                         level.height, rows.within({0, level.height}), kernels);
    auto maps = hogFeatures(scaled, requests, kernels);
    if (has_half) level.parts = std::move(maps.back());
    if (has_whole) level.roots = std::move(maps.front());
  });
  for (Level& level : levels) {
    level.part_map = level.parts_level < 0
                         ? &level.parts
                         : &levels[static_cast<std::size_t>(level.parts_level)].roots;
  }
}

/// Does any group look at that patch?
bool wanted(const Level& level, int column, int row) {
  const auto holds = [](const Span& span, int i) { return i >= span.begin && i < span.end; };
  for (const Search& s : level.searches) {
    for (const GroupSearch& g : s.groups) {
      if (holds(g.patch_columns, column) && holds(g.patch_rows, row)) return true;
    }
  }
  return false;
}

void DpmEngine::Bank::transform(std::vector<Level>& levels) const {
  tbb::parallel_for(std::size_t{0}, levels.size(), [&](std::size_t k) {
    Level& level = levels[k];
    level.spectra = AlignedFloats(static_cast<std::size_t>(level.patches_x * level.patches_y) *
                                  kSpectrumStride);
    tbb::parallel_for(0, level.patches_y, [&](int row) {
      for (int column = 0; column < level.patches_x; ++column) {
        if (!wanted(level, column, row)) continue;
        const auto patch = static_cast<std::size_t>(row * level.patches_x + column);
        kernels.forward(
            level.part_map->cell(level.patch_x0 + column * valid, level.patch_y0 + row * valid),
            level.part_map->rowStride(), level.spectra.data() + patch * kSpectrumStride);
      }
    });
  });
}

// ---- parts

void DpmEngine::Bank::convolveGroup(Level& level, std::size_t target, std::size_t group) const {
  GroupSearch& search = level.searches[target].groups[group];
  const Group& g = compiled[target].groups[group];
  const int lanes = 2 * kernels.lanes, w = options.window;
  const int across = search.patch_columns.size();
  const long stride = static_cast<long>(across) * valid * lanes;
  AlignedFloats responses(static_cast<std::size_t>(search.patch_rows.size() * valid * stride));
  const auto product = static_cast<std::size_t>(kFrequencies * 2 * lanes) + kProductGap;
  AlignedFloats products(product * kAtOnce);
  const int count = search.patch_rows.size() * across;
  for (int p = 0; p < count; p += kAtOnce) {
    const int n = std::min<int>(kAtOnce, count - p);
    const float* spectra[kAtOnce];
    float* out[kAtOnce];
    for (int i = 0; i < n; ++i) {
      const int row = search.patch_rows.begin + (p + i) / across;
      const int column = search.patch_columns.begin + (p + i) % across;
      spectra[i] = level.spectra.data() +
                   static_cast<std::size_t>(row * level.patches_x + column) * kSpectrumStride;
      out[i] = products.data() + static_cast<std::size_t>(i) * product;
    }
    kernels.products(g.weights.data(), spectra, n, out);
    for (int i = 0; i < n; ++i) {
      const int row = (p + i) / across, column = (p + i) % across;
      kernels.inverse(
          out[i], valid, valid,
          responses.data() + row * valid * stride + static_cast<long>(column) * valid * lanes,
          stride);
    }
  }
  const int columns = search.lattice_x.size(), rows = search.lattice_y.size();
  AlignedFloats scratch(static_cast<std::size_t>((2 * rows - 1 + 2 * w) * columns * lanes));
  const int x =
      2 * search.lattice_x.begin - w - level.patch_x0 - search.patch_columns.begin * valid;
  const int y = 2 * search.lattice_y.begin - w - level.patch_y0 - search.patch_rows.begin * valid;
  for (const auto& [odd_x, odd_y] : g.parities) {
    AlignedFloats best(static_cast<std::size_t>(rows * columns * lanes));
    kernels.displace(responses.data() + (y + odd_y) * stride + static_cast<long>(x + odd_x) * lanes,
                     stride, 2 * rows - 1, 2 * columns - 1, w, g.costs_x.data(), g.costs_y.data(),
                     scratch.data(), best.data());
    search.best.push_back(std::move(best));
  }
}

void DpmEngine::Bank::convolve(std::vector<Level>& levels) const {
  // Groups outside, levels inside: a group's weights stay in the cache.
  struct Task {
    std::size_t target, group;
  };
  std::vector<Task> tasks;
  for (std::size_t t = 0; t < targets.size(); ++t) {
    for (std::size_t g = 0; g < compiled[t].groups.size(); ++g) tasks.push_back({t, g});
  }
  tbb::parallel_for(std::size_t{0}, tasks.size(), [&](std::size_t i) {
    for (Level& level : levels) {
      if (!level.searches[tasks[i].target].groups[tasks[i].group].lattice_x.empty())
        convolveGroup(level, tasks[i].target, tasks[i].group);
    }
  });
}

// ---- scores

std::vector<DpmDetection> DpmEngine::Bank::collect(const Level& level, std::size_t target) const {
  std::vector<DpmDetection> found;
  const DpmTarget& t = targets[target];
  const Search& search = level.searches[target];
  const auto lanes = static_cast<std::size_t>(2 * kernels.lanes);
  const double pixel_x = cell / level.scale_x, pixel_y = cell / level.scale_y;
  AlignedFloats scores(static_cast<std::size_t>(level.root_x.size()));
  std::size_t first_lane = 0;
  for (std::size_t k = 0; k < t.model.components.size(); ++k) {
    const DpmComponent& c = t.model.components[k];
    const Span xs = search.x[k];
    for (int y = search.y[k].begin; y < search.y[k].end; ++y) {
      kernels.correlate(level.roots.cell(xs.begin, y), level.roots.rowStride(),
                        c.root.weights.data(), c.root.height, c.root.width, xs.size(),
                        scores.data());
      for (std::size_t p = 0; p < c.parts.size(); ++p) {
        const std::size_t group = (first_lane + p) / lanes, lane = (first_lane + p) % lanes;
        const GroupSearch& g = search.groups[group];
        const std::size_t parity = compiled[target].groups[group].lanes[lane].parity;
        const long row = y + halfOf(c.parts[p].anchor_y) - g.lattice_y.begin;
        const long column = xs.begin + halfOf(c.parts[p].anchor_x) - g.lattice_x.begin;
        const float* best = g.best[parity].data() +
                            static_cast<std::size_t>(row * g.lattice_x.size() + column) * lanes +
                            lane;
        for (int i = 0; i < xs.size(); ++i)
          scores[static_cast<std::size_t>(i)] += best[static_cast<std::size_t>(i) * lanes];
      }
      for (int x = xs.begin; x < xs.end; ++x) {
        const double score =
            static_cast<double>(scores[static_cast<std::size_t>(x - xs.begin)]) + c.offset;
        if (score < t.threshold) continue;
        DpmDetection d;
        d.target = static_cast<int>(target);
        d.component = static_cast<int>(k);
        d.score = score;
        d.box = {x * pixel_x, y * pixel_y, (x + c.width) * pixel_x, (y + c.height) * pixel_y};
        if (t.model.has_heading) d.heading = c.heading;
        found.push_back(d);
      }
    }
    first_lane += c.parts.size();
  }
  return found;
}

DpmEngine::DpmEngine(std::vector<DpmTarget> targets, DpmOptions options, SimdLevel level)
    : bank_(std::make_unique<Bank>(std::move(targets), options, level)) {}
DpmEngine::~DpmEngine() = default;
DpmEngine::DpmEngine(DpmEngine&&) noexcept = default;

const std::vector<DpmTarget>& DpmEngine::targets() const { return bank_->targets; }

std::vector<DpmDetection> DpmEngine::places(const Raster& image, const SearchRegion& region) const {
  std::vector<Level> levels = bank_->plan(image.width, image.height, region);
  bank_->buildFeatures(image, levels);
  bank_->transform(levels);
  bank_->convolve(levels);
  const std::size_t n = bank_->targets.size();
  std::vector<std::vector<DpmDetection>> found(levels.size() * n);
  tbb::parallel_for(std::size_t{0}, found.size(),
                    [&](std::size_t i) { found[i] = bank_->collect(levels[i / n], i % n); });
  std::vector<DpmDetection> all;
  for (const auto& some : found) all.insert(all.end(), some.begin(), some.end());
  return all;
}

std::vector<DpmDetection> DpmEngine::detect(const Raster& image, const SearchRegion& region) const {
  return suppressed(places(image, region), bank_->options.overlap);
}

}  // namespace perception
