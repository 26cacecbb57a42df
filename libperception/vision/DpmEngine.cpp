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

constexpr int kSmallestImage = 5;  // [cells] voc-release: the pyramid's last level

/// A part as a lane of a group: its filter shifted so that its anchor is even.
struct Lane {
  int component = -1, part = -1;
};

/// 2 * lanes filters that are convolved together.
struct Group {
  std::vector<Lane> lanes;
  AlignedFloats weights;           // per frequency and feature: A.re, A.im, B.re, B.im
  AlignedFloats costs_x, costs_y;  // (2 window + 1) x 2 lanes
};

/// floor(a / 2), for negative numbers too.
int halfOf(int a) { return a >= 0 ? a / 2 : -((1 - a) / 2); }

/// A target with its filters as the kernels want them.
struct Compiled {
  std::vector<Group> groups;
  Span shift_x, shift_y;                                   // [root cells] of the parts' anchors
  int least_width = 0, least_height = 0, most_height = 0;  // [cells]
};

/// Responses of a group at the places of a level's parts, displaced at best.
struct GroupBest {
  AlignedFloats best;
};

/// What one target needs of one level.
struct Search {
  Span rows;                        // [root cells] of root corners
  Span lattice_x, lattice_y;        // [root cells] of parts' places, halved
  Span patch_rows;                  // of the level's patches
  std::vector<AlignedFloats> best;  // per group, lattice by 2 * lanes
  bool empty() const { return rows.empty(); }
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
  std::vector<AlignedFloats> spectra;  // per patch; empty where nobody looks
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
  std::vector<Level> plan(int width, int height, const std::optional<GroundGate>& gate) const;
  void planSearches(Level& level, const std::optional<GroundGate>& gate) const;
  void planPatches(Level& level) const;
  Span rootRows(const DpmTarget& target, const Compiled& c, const Level& level,
                const std::optional<GroundGate>& gate) const;
  void buildFeatures(const Raster& image, std::vector<Level>& levels) const;
  void transform(std::vector<Level>& levels) const;
  void convolve(std::vector<Level>& levels) const;
  void convolveGroup(Level& level, std::size_t target, std::size_t group) const;
  std::vector<DpmDetection> collect(const Level& level, std::size_t target,
                                    const std::optional<GroundGate>& gate) const;
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
        largest = std::max({largest, part.filter.height + (part.anchor_y & 1),
                            part.filter.width + (part.anchor_x & 1)});
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
  bool first = true;
  const auto& components = target.model.components;
  for (std::size_t k = 0; k < components.size(); ++k) {
    const DpmComponent& component = components[k];
    const int height = std::max(component.height, component.root.height);
    c.least_width = first ? component.root.width : std::min(c.least_width, component.root.width);
    c.least_height = first ? height : std::min(c.least_height, height);
    c.most_height = std::max(c.most_height, height);
    first = false;
    for (std::size_t p = 0; p < component.parts.size(); ++p) {
      lanes.push_back({static_cast<int>(k), static_cast<int>(p)});
      const int x = halfOf(component.parts[p].anchor_x), y = halfOf(component.parts[p].anchor_y);
      c.shift_x = c.shift_x.with({x, x + 1});
      c.shift_y = c.shift_y.with({y, y + 1});
    }
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
  group.weights = AlignedFloats(static_cast<std::size_t>(kFrequencies * kFeatures * 4 * L));
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
    std::fill(patch.begin(), patch.end(), 0.F);
    const int right = part.anchor_x & 1, down = part.anchor_y & 1;
    const int row = part.filter.width * kFeatures;
    for (int y = 0; y < part.filter.height; ++y)
      std::copy_n(part.filter.weights.begin() + y * row, row,
                  patch.begin() + ((y + down) * kPatch + right) * kFeatures);
    kernels.forward(patch.data(), kPatch * kFeatures, spectrum.data());
    const int i = static_cast<int>(lane), half = i / L;
    for (int w = 0; w < kFrequencies; ++w) {
      for (int f = 0; f < kFeatures; ++f) {
        float* to = group.weights.data() + (w * kFeatures + f) * 4 * L + half * 2 * L + i % L;
        const float* from = spectrum.data() + w * 2 * kFeatures + f;
        // Conjugate: a correlation; scaled for the inverse transform.
        to[0] = from[0] / static_cast<float>(kCells);
        to[L] = -from[kFeatures] / static_cast<float>(kCells);
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

Span DpmEngine::Bank::rootRows(const DpmTarget& target, const Compiled& c, const Level& level,
                               const std::optional<GroundGate>& gate) const {
  Span rows{-options.padding, level.cells_y + options.padding - c.least_height + 1};
  if (!gate) return rows;
  Span allowed;
  for (const DpmComponent& component : target.model.components) {
    const double pixel = cell / level.scale_y;
    const auto bottoms = gate->bottoms(component.height * pixel, target.low, target.high);
    allowed =
        allowed.with({static_cast<int>(std::ceil(bottoms.begin / pixel)) - component.height,
                      static_cast<int>(std::floor(bottoms.end / pixel)) - component.height + 1});
  }
  return rows.within(allowed);
}

void DpmEngine::Bank::planSearches(Level& level, const std::optional<GroundGate>& gate) const {
  const int pad = options.padding;
  for (std::size_t t = 0; t < targets.size(); ++t) {
    const Compiled& c = compiled[t];
    Search search;
    search.rows = rootRows(targets[t], c, level, gate);
    const int columns = level.cells_x + 2 * pad - c.least_width + 1;
    if (search.rows.empty() || columns <= 0) {
      level.searches.emplace_back();
      continue;
    }
    int tallest = 0;
    for (const auto& component : targets[t].model.components)
      tallest = std::max(tallest, component.root.height);
    level.root_x = {-pad, level.cells_x + pad};
    level.root_y = level.root_y.with({search.rows.begin, search.rows.end - 1 + tallest});
    if (!c.groups.empty()) {
      search.lattice_x = {-pad + c.shift_x.begin, -pad + columns - 1 + c.shift_x.end};
      search.lattice_y = {search.rows.begin + c.shift_y.begin, search.rows.end - 1 + c.shift_y.end};
    }
    level.searches.push_back(std::move(search));
  }
}

void DpmEngine::Bank::planPatches(Level& level) const {
  Span x, y;  // [part cells] of parts' places, moves included
  const int w = options.window;
  for (const Search& s : level.searches) {
    if (s.lattice_x.empty()) continue;
    x = x.with({2 * s.lattice_x.begin - w, 2 * s.lattice_x.end - 1 + w});
    y = y.with({2 * s.lattice_y.begin - w, 2 * s.lattice_y.end - 1 + w});
  }
  if (x.empty()) return;
  level.patch_x0 = x.begin;
  level.patch_y0 = y.begin;
  level.patches_x = (x.size() + valid - 1) / valid;
  level.patches_y = (y.size() + valid - 1) / valid;
  for (Search& s : level.searches) {
    if (s.lattice_y.empty()) continue;
    s.patch_rows = {(2 * s.lattice_y.begin - w - level.patch_y0) / valid,
                    (2 * (s.lattice_y.end - 1) + w - level.patch_y0) / valid + 1};
  }
  level.part_x = {x.begin, x.begin + level.patches_x * valid + kPatch - valid};
  level.part_y = {y.begin, y.begin + level.patches_y * valid + kPatch - valid};
}

std::vector<Level> DpmEngine::Bank::plan(int width, int height,
                                         const std::optional<GroundGate>& gate) const {
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
    planSearches(level, gate);
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

void DpmEngine::Bank::transform(std::vector<Level>& levels) const {
  tbb::parallel_for(std::size_t{0}, levels.size(), [&](std::size_t k) {
    Level& level = levels[k];
    level.spectra.resize(static_cast<std::size_t>(level.patches_x * level.patches_y));
    tbb::parallel_for(0, level.patches_y, [&](int row) {
      const bool wanted = std::any_of(level.searches.begin(), level.searches.end(), [&](auto& s) {
        return row >= s.patch_rows.begin && row < s.patch_rows.end;
      });
      if (!wanted) return;
      for (int column = 0; column < level.patches_x; ++column) {
        AlignedFloats spectrum(kSpectrum);
        kernels.forward(
            level.part_map->cell(level.patch_x0 + column * valid, level.patch_y0 + row * valid),
            level.part_map->rowStride(), spectrum.data());
        level.spectra[static_cast<std::size_t>(row * level.patches_x + column)] =
            std::move(spectrum);
      }
    });
  });
}

// ---- parts

void DpmEngine::Bank::convolveGroup(Level& level, std::size_t target, std::size_t group) const {
  Search& search = level.searches[target];
  const Group& g = compiled[target].groups[group];
  const int lanes = 2 * kernels.lanes, w = options.window;
  const int columns = level.patches_x * valid, rows = search.patch_rows.size() * valid;
  const long stride = static_cast<long>(columns) * lanes;
  AlignedFloats responses(static_cast<std::size_t>(rows * stride));
  const auto product = static_cast<std::size_t>(kFrequencies * 2 * lanes);
  AlignedFloats products(product * kAtOnce);
  const int first = search.patch_rows.begin * level.patches_x;
  const int count = search.patch_rows.size() * level.patches_x;
  for (int p = 0; p < count; p += kAtOnce) {
    const int n = std::min<int>(kAtOnce, count - p);
    const float* spectra[kAtOnce];
    float* out[kAtOnce];
    for (int i = 0; i < n; ++i) {
      spectra[i] = level.spectra[static_cast<std::size_t>(first + p + i)].data();
      out[i] = products.data() + static_cast<std::size_t>(i) * product;
    }
    kernels.products(g.weights.data(), spectra, n, out);
    for (int i = 0; i < n; ++i) {
      const int row = (p + i) / level.patches_x, column = (p + i) % level.patches_x;
      kernels.inverse(
          out[i], valid, valid,
          responses.data() + row * valid * stride + static_cast<long>(column) * valid * lanes,
          stride);
    }
  }
  const int lattice_x = search.lattice_x.size(), lattice_y = search.lattice_y.size();
  AlignedFloats scratch(static_cast<std::size_t>((2 * lattice_y - 1 + 2 * w) * lattice_x * lanes));
  AlignedFloats best(static_cast<std::size_t>(lattice_y * lattice_x * lanes));
  const int x = 2 * search.lattice_x.begin - w - level.patch_x0;
  const int y = 2 * search.lattice_y.begin - w - level.patch_y0 - search.patch_rows.begin * valid;
  kernels.displace(responses.data() + y * stride + static_cast<long>(x) * lanes, stride,
                   2 * lattice_y - 1, 2 * lattice_x - 1, w, g.costs_x.data(), g.costs_y.data(),
                   scratch.data(), best.data());
  search.best[group] = std::move(best);
}

void DpmEngine::Bank::convolve(std::vector<Level>& levels) const {
  // Groups outside, levels inside: a group's weights stay in the cache.
  struct Task {
    std::size_t target, group;
  };
  std::vector<Task> tasks;
  for (std::size_t t = 0; t < targets.size(); ++t) {
    for (std::size_t g = 0; g < compiled[t].groups.size(); ++g) tasks.push_back({t, g});
    for (Level& level : levels) level.searches[t].best.resize(compiled[t].groups.size());
  }
  tbb::parallel_for(std::size_t{0}, tasks.size(), [&](std::size_t i) {
    for (Level& level : levels) {
      if (!level.searches[tasks[i].target].lattice_x.empty())
        convolveGroup(level, tasks[i].target, tasks[i].group);
    }
  });
}

// ---- scores

std::vector<DpmDetection> DpmEngine::Bank::collect(const Level& level, std::size_t target,
                                                   const std::optional<GroundGate>& gate) const {
  std::vector<DpmDetection> found;
  const DpmTarget& t = targets[target];
  const Search& search = level.searches[target];
  if (search.empty()) return found;
  const int pad = options.padding, lanes = 2 * kernels.lanes;
  const double pixel_x = cell / level.scale_x, pixel_y = cell / level.scale_y;
  std::vector<float> scores(static_cast<std::size_t>(level.cells_x + 2 * pad + 16));
  std::size_t first_lane = 0;
  for (std::size_t k = 0; k < t.model.components.size(); ++k) {
    const DpmComponent& c = t.model.components[k];
    const int columns = level.cells_x + 2 * pad - c.root.width + 1;
    const int last_row = level.cells_y + pad - c.root.height;
    for (int y = search.rows.begin; y < search.rows.end && y <= last_row && columns > 0; ++y) {
      const double top = y * pixel_y, bottom = (y + c.height) * pixel_y;
      if (gate && !gate->admits(top, bottom, t.low, t.high)) continue;
      kernels.correlate(level.roots.cell(-pad, y), level.roots.rowStride(), c.root.weights.data(),
                        c.root.height, c.root.width, columns, scores.data());
      for (std::size_t p = 0; p < c.parts.size(); ++p) {
        const std::size_t lane = first_lane + p;
        const long row = y + halfOf(c.parts[p].anchor_y) - search.lattice_y.begin;
        const long column = -pad + halfOf(c.parts[p].anchor_x) - search.lattice_x.begin;
        const float* best = search.best[lane / static_cast<std::size_t>(lanes)].data() +
                            (row * search.lattice_x.size() + column) * lanes +
                            static_cast<long>(lane % static_cast<std::size_t>(lanes));
        for (int x = 0; x < columns; ++x)
          scores[static_cast<std::size_t>(x)] += best[static_cast<long>(x) * lanes];
      }
      for (int x = 0; x < columns; ++x) {
        const double score = static_cast<double>(scores[static_cast<std::size_t>(x)]) + c.offset;
        if (score < t.threshold) continue;
        DpmDetection d;
        d.target = static_cast<int>(target);
        d.component = static_cast<int>(k);
        d.score = score;
        d.box = {(x - pad) * pixel_x, top, (x - pad + c.width) * pixel_x, bottom};
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

std::vector<DpmDetection> DpmEngine::places(const Raster& image,
                                            const std::optional<GroundGate>& gate) const {
  std::vector<Level> levels = bank_->plan(image.width, image.height, gate);
  bank_->buildFeatures(image, levels);
  bank_->transform(levels);
  bank_->convolve(levels);
  const std::size_t n = bank_->targets.size();
  std::vector<std::vector<DpmDetection>> found(levels.size() * n);
  tbb::parallel_for(std::size_t{0}, found.size(),
                    [&](std::size_t i) { found[i] = bank_->collect(levels[i / n], i % n, gate); });
  std::vector<DpmDetection> all;
  for (const auto& some : found) all.insert(all.end(), some.begin(), some.end());
  return all;
}

std::vector<DpmDetection> DpmEngine::detect(const Raster& image,
                                            const std::optional<GroundGate>& gate) const {
  return suppressed(places(image, gate), bank_->options.overlap);
}

}  // namespace perception
