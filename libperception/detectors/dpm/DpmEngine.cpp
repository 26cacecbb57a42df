#include "libperception/detectors/dpm/DpmEngine.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "libperception/detectors/dpm/DpmBank.h"
#include "libperception/detectors/dpm/DpmPyramid.h"
#include "libperception/detectors/dpm/DpmSuppression.h"

namespace perception {
namespace {

constexpr std::size_t kProductGap = 272;  // [floats] as kDpmSpectrumStride

// ---- parts

void convolveGroup(const DpmBank& bank, DpmLevel& level, std::size_t target, std::size_t group) {
  DpmGroupSearch& search = level.searches[target].groups[group];
  const DpmBank::Group& g = bank.groups[target][group];
  const int lanes = 2 * bank.kernels.lanes, w = bank.options.window;
  const int across = search.patch_columns.size();
  const long stride = static_cast<long>(across) * bank.valid * lanes;
  AlignedFloats responses(static_cast<std::size_t>(search.patch_rows.size() * bank.valid * stride));
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
                   static_cast<std::size_t>(row * level.patches_x + column) * kDpmSpectrumStride;
      out[i] = products.data() + static_cast<std::size_t>(i) * product;
    }
    bank.kernels.products(g.weights.data(), spectra, n, out);
    for (int i = 0; i < n; ++i) {
      const int row = (p + i) / across, column = (p + i) % across;
      bank.kernels.inverse(out[i], bank.valid, bank.valid,
                           responses.data() + row * bank.valid * stride +
                               static_cast<long>(column) * bank.valid * lanes,
                           stride);
    }
  }
  const int columns = search.lattice_x.size(), rows = search.lattice_y.size();
  AlignedFloats scratch(static_cast<std::size_t>((2 * rows - 1 + 2 * w) * columns * lanes));
  const int x =
      2 * search.lattice_x.begin - w - level.patch_x0 - search.patch_columns.begin * bank.valid;
  const int y =
      2 * search.lattice_y.begin - w - level.patch_y0 - search.patch_rows.begin * bank.valid;
  for (const auto& [odd_x, odd_y] : g.parities) {
    AlignedFloats best(static_cast<std::size_t>(rows * columns * lanes));
    bank.kernels.displace(
        responses.data() + (y + odd_y) * stride + static_cast<long>(x + odd_x) * lanes, stride,
        2 * rows - 1, 2 * columns - 1, w, g.costs_x.data(), g.costs_y.data(), scratch.data(),
        best.data());
    search.best.push_back(std::move(best));
  }
}

void convolve(const DpmBank& bank, std::vector<DpmLevel>& levels) {
  // Groups in the outer loop, levels in the inner one: a group's weights stay in the cache.
  struct Task {
    std::size_t target, group;
  };
  std::vector<Task> tasks;
  for (std::size_t t = 0; t < bank.targets.size(); ++t) {
    for (std::size_t g = 0; g < bank.groups[t].size(); ++g) tasks.push_back({t, g});
  }
  tbb::parallel_for(std::size_t{0}, tasks.size(), [&](std::size_t i) {
    for (DpmLevel& level : levels) {
      if (!level.searches[tasks[i].target].groups[tasks[i].group].lattice_x.empty())
        convolveGroup(bank, level, tasks[i].target, tasks[i].group);
    }
  });
}

// ---- scores

/// Index into DpmComponent::octaves by the scale of a root (voc-release5, loc_feat.m: the first
/// `interval` levels are finer than the image, the next ones down to half its scale).
std::size_t octaveOf(double scale) {
  constexpr double kRounding = 1e-3;  // scales are rounded to whole pixels
  return scale > 1 + kRounding ? 0 : scale > 0.5 + kRounding ? 1 : 2;
}

std::vector<DpmDetection> collect(const DpmBank& bank, const DpmLevel& level, std::size_t target) {
  std::vector<DpmDetection> found;
  const DpmTarget& t = bank.targets[target];
  const DpmSearch& search = level.searches[target];
  const auto lanes = static_cast<std::size_t>(2 * bank.kernels.lanes);
  const double pixel_x = bank.cell / level.scale_x, pixel_y = bank.cell / level.scale_y;
  AlignedFloats scores(static_cast<std::size_t>(level.root_x.size()));
  std::size_t first_lane = 0;
  for (std::size_t k = 0; k < t.model.components.size(); ++k) {
    const DpmComponent& c = t.model.components[k];
    const double offset = c.offset + c.octaves[octaveOf(level.scale_x)];
    const Span xs = search.x[k];
    for (int y = search.y[k].begin; y < search.y[k].end; ++y) {
      bank.kernels.correlate(level.roots.cell(xs.begin, y), level.roots.rowStride(),
                             c.root.weights.data(), c.root.height, c.root.width, xs.size(),
                             scores.data());
      for (std::size_t p = 0; p < c.parts.size(); ++p) {
        const std::size_t group = (first_lane + p) / lanes, lane = (first_lane + p) % lanes;
        const DpmGroupSearch& g = search.groups[group];
        const std::size_t parity = bank.groups[target][group].lanes[lane].parity;
        const long row = y + DpmBank::halfOf(c.parts[p].anchor_y) - g.lattice_y.begin;
        const long column = xs.begin + DpmBank::halfOf(c.parts[p].anchor_x) - g.lattice_x.begin;
        const float* best = g.best[parity].data() +
                            static_cast<std::size_t>(row * g.lattice_x.size() + column) * lanes +
                            lane;
        for (int i = 0; i < xs.size(); ++i)
          scores[static_cast<std::size_t>(i)] += best[static_cast<std::size_t>(i) * lanes];
      }
      for (int x = xs.begin; x < xs.end; ++x) {
        const double score =
            static_cast<double>(scores[static_cast<std::size_t>(x - xs.begin)]) + offset;
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

}  // namespace

DpmEngine::DpmEngine(std::vector<DpmTarget> targets, DpmOptions options, SimdLevel level)
    : bank_(std::make_unique<DpmBank>(std::move(targets), options, level)) {}
DpmEngine::~DpmEngine() = default;
DpmEngine::DpmEngine(DpmEngine&&) noexcept = default;

const std::vector<DpmTarget>& DpmEngine::targets() const { return bank_->targets; }

std::vector<DpmDetection> DpmEngine::places(const Raster& image, const SearchRegion& region) const {
  std::vector<DpmLevel> levels = planPyramid(*bank_, image.width, image.height, region);
  buildPyramid(*bank_, image, levels);
  convolve(*bank_, levels);
  const std::size_t n = bank_->targets.size();
  std::vector<std::vector<DpmDetection>> found(levels.size() * n);
  tbb::parallel_for(std::size_t{0}, found.size(),
                    [&](std::size_t i) { found[i] = collect(*bank_, levels[i / n], i % n); });
  std::vector<DpmDetection> all;
  for (const auto& some : found) all.insert(all.end(), some.begin(), some.end());
  return all;
}

std::vector<DpmDetection> DpmEngine::detect(const Raster& image, const SearchRegion& region) const {
  return suppressed(places(image, region), bank_->options.overlap);
}

}  // namespace perception
