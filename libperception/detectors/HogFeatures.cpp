#include "libperception/detectors/HogFeatures.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace perception {
namespace {

constexpr int kMargin = 32;  // padding of a row [floats], for access by whole vectors

std::size_t floats(long a, long b) { return static_cast<std::size_t>(a * b); }

/// Up to kTaps source pixels for each pixel along one axis.
struct Resampling {
  static constexpr int kTaps = 3;
  std::vector<int> first;
  std::vector<float> weights;  // kTaps planes
  std::size_t size() const { return first.size(); }
  float weight(int tap, int i) const {
    return weights[static_cast<std::size_t>(tap) * size() + static_cast<std::size_t>(i)];
  }
};

// Source pixels that pixel i of `to` covers: by area when smaller, between two centers when larger.
Resampling resampling(int from, int to) {
  Resampling r;
  const auto n = static_cast<std::size_t>(to);
  r.first.resize(n);
  r.weights.assign(n * Resampling::kTaps, 0.F);
  const double ratio = static_cast<double>(from) / to;
  for (int i = 0; i < to; ++i) {
    double begin = i * ratio, end = (i + 1) * ratio;
    if (ratio <= 1) {
      const double center = (i + 0.5) * ratio - 0.5;
      begin = center, end = center + 1;  // upsampling: linear between pixel centers
    }
    begin = std::clamp(begin, 0.0, from - 1e-6);
    end = std::clamp(end, begin + 1e-6, static_cast<double>(from));
    const int first = std::clamp(static_cast<int>(begin), 0, std::max(0, from - Resampling::kTaps));
    r.first[static_cast<std::size_t>(i)] = first;
    double sum = 0;
    double part[Resampling::kTaps];
    for (int t = 0; t < Resampling::kTaps; ++t) {
      part[t] = std::max(0.0, std::min(end, first + t + 1.0) - std::max(begin, first + t + 0.0));
      sum += part[t];
    }
    for (int t = 0; t < Resampling::kTaps; ++t)
      r.weights[static_cast<std::size_t>(t) * n + static_cast<std::size_t>(i)] =
          static_cast<float>(part[t] / sum);
  }
  return r;
}

PlanarImage emptyImage(int width, int height, Span rows) {
  PlanarImage out;
  out.width = width;
  out.height = height;
  out.rows = rows;
  out.stride = width + kMargin;
  out.values = AlignedFloats(floats(rows.size() * 3L, out.stride));
  return out;
}

/// Histograms of one feature map.
struct Histograms {
  FeatureRequest request;
  int cells_x = 0, cells_y = 0;
  Span features;               // [cells] rows with features in the request
  Span rows;                   // [cells] rows with histograms: one more at either side
  int stride = 0;              // of one orientation
  std::vector<int> cell;       // per pixel column: lower cell + 1
  std::vector<float> weights;  // per pixel column: of the lower and of the upper cell
  AlignedFloats values, row;   // [cell row][orientation][cell + 1]

  long rowFloats() const { return static_cast<long>(kOrientations) * stride; }
  float* at(int y) { return values.data() + (y - rows.begin) * rowFloats(); }
};

Histograms histograms(const PlanarImage& image, const FeatureRequest& request) {
  Histograms h;
  h.request = request;
  h.cells_x = cellsAcross(image.width, request.side);
  h.cells_y = cellsAcross(image.height, request.side);
  h.features = request.y.within({1, h.cells_y - 1});
  if (h.features.empty() || h.cells_x < 3) {
    h.features = {};
    return h;
  }
  h.rows = {h.features.begin - 1, h.features.end + 1};
  h.stride = (h.cells_x + 2 + kMargin + 15) / 16 * 16;
  const int visible = h.cells_x * request.side;
  for (int x = 0; x < visible; ++x) {
    const double place = (x + 0.5) / request.side - 0.5;
    const double lower = std::floor(place), above = place - lower;
    h.cell.push_back(static_cast<int>(lower) + 1);
    h.weights.push_back(static_cast<float>(1 - above));
    h.weights.push_back(static_cast<float>(above));
  }
  h.values = AlignedFloats(floats(h.rows.size(), h.rowFloats()) + kMargin);
  h.row = AlignedFloats(static_cast<std::size_t>(h.rowFloats()) + kMargin);
  std::fill_n(h.values.data(), h.values.size(), 0.F);
  return h;
}

/// Adds the pixels of row y.
void addPixels(const float* magnitude, const int* bin, int y, Histograms& h,
               const VisionKernels& kernels) {
  const int side = h.request.side;
  if (y < 1 || y > h.cells_y * side - 2) return;
  const double place = (y + 0.5) / side - 0.5;
  const int lower = static_cast<int>(std::floor(place));
  const float above = static_cast<float>(place - lower);
  const bool in_lower = lower >= h.rows.begin && lower < h.rows.end;
  const bool in_upper = lower + 1 >= h.rows.begin && lower + 1 < h.rows.end;
  if (!in_lower && !in_upper) return;
  const int n = static_cast<int>(h.rowFloats());
  std::memset(h.row.data(), 0, static_cast<std::size_t>(n) * sizeof(float));
  kernels.bin(magnitude, bin, h.cell.data(), h.weights.data(), 1, h.cells_x * side - 1, h.stride,
              h.row.data());
  if (in_lower) kernels.accumulate(h.row.data(), 1 - above, n, h.at(lower));
  if (in_upper) kernels.accumulate(h.row.data(), above, n, h.at(lower + 1));
}

void clearCells(float* begin, int count) {
  std::memset(begin, 0, static_cast<std::size_t>(count) * kHogFeatures * sizeof(float));
  for (int i = 0; i < count; ++i) begin[i * kHogFeatures + kHogFeatures - 1] = 1;
}

FeatureMap featuresOf(Histograms& h, const VisionKernels& kernels) {
  FeatureMap map;
  map.x = h.request.x;
  map.y = h.request.y;
  map.values = AlignedFloats(floats(map.y.size(), map.rowStride()) + kMargin);
  AlignedFloats energies(floats(std::max(1, h.rows.size()), h.stride) + kMargin);
  const auto energy = [&](int y) {
    return energies.data() + static_cast<long>(y - h.rows.begin) * h.stride;
  };
  for (int y = h.rows.begin; y < h.rows.end; ++y)
    kernels.energy(h.at(y), h.stride, h.cells_x + 2, energy(y));
  AlignedFloats row(floats(h.cells_x + 1, kHogFeatures));
  const Span seen = map.x.within({1, h.cells_x - 1});
  for (int y = map.y.begin; y < map.y.end; ++y) {
    if (y < h.features.begin || y >= h.features.end || seen.empty()) {
      clearCells(map.cell(map.x.begin, y), map.x.size());
      continue;
    }
    kernels.features(h.at(y) + 1, h.stride, h.cells_x, energy(y - 1) + 1, energy(y) + 1,
                     energy(y + 1) + 1, row.data());
    clearCells(map.cell(map.x.begin, y), seen.begin - map.x.begin);
    std::memcpy(map.cell(seen.begin, y), row.data() + static_cast<long>(seen.begin) * kHogFeatures,
                floats(seen.size(), kHogFeatures) * sizeof(float));
    clearCells(map.cell(seen.end, y), map.x.end - seen.end);
  }
  return map;
}

}  // namespace

Span Span::with(const Span& other) const {
  if (empty()) return other;
  if (other.empty()) return *this;
  return {std::min(begin, other.begin), std::max(end, other.end)};
}

Span Span::within(const Span& limits) const {
  return {std::max(begin, limits.begin), std::min(end, limits.end)};
}

PixelRow PlanarImage::row(int y) const { return {{channel(y, 0), channel(y, 1), channel(y, 2)}}; }

PlanarImage planarImage(const Raster& image) {
  PlanarImage out = emptyImage(image.width, image.height, {0, image.height});
  const int step = image.channels;
  for (int y = 0; y < image.height; ++y) {
    const std::uint8_t* from =
        image.pixels.data() + floats(y, image.width) * static_cast<std::size_t>(step);
    for (int c = 0; c < 3; ++c) {
      float* to = out.channel(y, c);
      const std::uint8_t* source = from + (step >= 3 ? c : 0);
      for (int x = 0; x < image.width; ++x) to[x] = source[static_cast<long>(x) * step];
      std::fill_n(to + image.width, kMargin, 0.F);
    }
  }
  return out;
}

PlanarImage halved(const PlanarImage& image) {
  const int width = std::max(1, image.width / 2), height = std::max(1, image.height / 2);
  PlanarImage out = emptyImage(width, height, {0, height});
  for (int y = 0; y < height; ++y) {
    for (int c = 0; c < 3; ++c) {
      const float* a = image.channel(std::min(2 * y, image.height - 1), c);
      const float* b = image.channel(std::min(2 * y + 1, image.height - 1), c);
      float* to = out.channel(y, c);
      for (int x = 0; x < width; ++x)
        to[x] = 0.25F * ((a[2 * x] + a[2 * x + 1]) + (b[2 * x] + b[2 * x + 1]));
      std::fill_n(to + width, kMargin, 0.F);
    }
  }
  return out;
}

PlanarImage resampled(const PlanarImage& image, int width, int height, Span rows,
                      const VisionKernels& kernels) {
  PlanarImage out = emptyImage(width, height, rows);
  const Resampling across = resampling(image.width, width);
  const Resampling down = resampling(image.height, height);
  AlignedFloats blended(static_cast<std::size_t>(image.stride));
  for (int y = rows.begin; y < rows.end; ++y) {
    const int first = down.first[static_cast<std::size_t>(y)];
    float weights[Resampling::kTaps];
    for (int t = 0; t < Resampling::kTaps; ++t) weights[t] = down.weight(t, y);
    for (int c = 0; c < 3; ++c) {
      const float* sources[Resampling::kTaps];
      for (int t = 0; t < Resampling::kTaps; ++t)
        sources[t] = image.channel(std::min(first + t, image.height - 1), c);
      kernels.blend(sources, weights, Resampling::kTaps, image.width, blended.data());
      kernels.gather(blended.data(), across.first.data(), across.weights.data(), width,
                     out.channel(y, c));
      std::fill_n(out.channel(y, c) + width, kMargin, 0.F);
    }
  }
  return out;
}

int cellsAcross(int pixels, int side) {
  return static_cast<int>(std::lround(static_cast<double>(pixels) / side));
}

Span pixelRows(Span cells, int side, int height) {
  // Histograms need one more row at each side, each half a cell of further pixels, and gradients
  // one more pixel. Beyond the image the last row with a gradient is replicated.
  const Span rows{(cells.begin - 1) * side - side / 2 - 1, (cells.end + 1) * side + side / 2 + 1};
  Span out = rows.within({0, height});
  if (rows.end >= height - 2) out = out.with({std::max(0, height - 3), height});
  return out;
}

std::vector<FeatureMap> hogFeatures(const PlanarImage& image,
                                    const std::vector<FeatureRequest>& requests,
                                    const VisionKernels& kernels) {
  std::vector<Histograms> all;
  Span wanted;
  int visible = 0;
  for (const FeatureRequest& request : requests) {
    all.push_back(histograms(image, request));
    const Histograms& h = all.back();
    if (h.features.empty()) continue;
    wanted = wanted.with({h.rows.begin * request.side - request.side / 2,
                          h.rows.end * request.side + request.side / 2});
    visible = std::max(visible, h.cells_x * request.side);
  }
  const auto columns = static_cast<std::size_t>(std::max(visible, image.width) + kMargin);
  AlignedFloats magnitude(columns);
  std::vector<int> bin(columns, 0);
  int computed = -1;
  const int last_x = image.width - 2, last_y = image.height - 2;
  if (last_x < 1 || last_y < 1) wanted = {};
  for (int y = std::max(1, wanted.begin); y < wanted.end; ++y) {
    const int from = std::min(y, last_y);
    if (from < image.rows.begin + 1 || from > image.rows.end - 2) continue;
    if (from != computed) {
      const PixelRow above = image.row(from - 1), row = image.row(from),
                     below = image.row(from + 1);
      kernels.gradients(&above, &row, &below, image.width, magnitude.data(), bin.data());
      for (int x = last_x + 1; x < visible; ++x) {
        magnitude[static_cast<std::size_t>(x)] = magnitude[static_cast<std::size_t>(last_x)];
        bin[static_cast<std::size_t>(x)] = bin[static_cast<std::size_t>(last_x)];
      }
      computed = from;
    }
    for (Histograms& h : all) {
      if (!h.features.empty()) addPixels(magnitude.data(), bin.data(), y, h, kernels);
    }
  }
  std::vector<FeatureMap> out;
  for (Histograms& h : all) out.push_back(featuresOf(h, kernels));
  return out;
}

}  // namespace perception
