#include "libperception/lidar/two_spacings/PersonResponse.h"

#include <algorithm>
#include <cmath>

#include "libperception/lidar/two_spacings/PersonPeaks.h"
#include "libperception/simd/Dispatch.h"
#include "libperception/simd/Vector8.h"

namespace perception {

double personKernel(double r, const PersonParams& params) {
  const double s2 = params.sigma * params.sigma, u = r * r / (2 * s2);
  const double fourth = params.kernel == PersonParams::Kernel::kPrinted
                            ? r * r * u
                            : 2 * u * u;  // r^4 / (2 s^2), r^4 / (2 s^4)
  return std::exp(-u) / (kPi * s2) * ((1 - u) + 0.15 * (1 - fourth));
}

PersonResponse::PersonResponse(const std::vector<float>& x, const std::vector<float>& y,
                               const std::vector<float>& weight, const PersonParams& params)
    : cell_(params.cell),
      // The margin includes up to seven cells of padding of the kernel rows.
      margin_(static_cast<std::size_t>(std::ceil(params.support / params.cell)) + 8) {
  if (x.empty()) return;
  place(x, y, weight);
  scatter(params);
}

namespace {

struct Spread {
  float lowest, highest;
};

PERCEPTION_WIDER Spread spreadOf(const float* v, std::size_t count) {
  Float8 low = eight(v[0]), high = low;
  std::size_t i = 0;
  for (; i + kLanes <= count; i += kLanes) {
    const Float8 more = load8(v + i);
    low = smaller(low, more), high = larger(high, more);
  }
  Spread bounds{v[0], v[0]};
  for (int k = 0; k < kLanes; ++k) {
    bounds.lowest = std::min(bounds.lowest, low[k]);
    bounds.highest = std::max(bounds.highest, high[k]);
  }
  for (; i < count; ++i) {
    bounds.lowest = std::min(bounds.lowest, v[i]);
    bounds.highest = std::max(bounds.highest, v[i]);
  }
  return bounds;
}

PERCEPTION_WIDER void findCells(const float* __restrict x, const float* __restrict y,
                                std::size_t count, double x0, double y0, double per_meter,
                                std::int32_t columns, std::uint32_t* __restrict cell) {
  for (std::size_t i = 0; i < count; ++i) {
    const auto column = static_cast<std::int32_t>((static_cast<double>(x[i]) - x0) * per_meter);
    const auto row = static_cast<std::int32_t>((static_cast<double>(y[i]) - y0) * per_meter);
    cell[i] = static_cast<std::uint32_t>(row * columns + column);
  }
}

/// Start of the first group of sixteen values of which one reaches the threshold.
PERCEPTION_WIDER std::size_t firstGroupWith(const float* v, std::size_t begin, std::size_t end,
                                            float least) {
  for (; begin + 2 * kLanes <= end; begin += 2 * kLanes) {
    const Int8 any = (load8(v + begin) >= least) | (load8(v + begin + kLanes) >= least);
    const std::int32_t all =
        (any[0] | any[1]) | (any[2] | any[3]) | (any[4] | any[5]) | (any[6] | any[7]);
    if (all != 0) break;
  }
  return begin;
}

}  // namespace

void PersonResponse::place(const std::vector<float>& x, const std::vector<float>& y,
                           const std::vector<float>& weight) {
  const Spread x_bounds = spreadOf(x.data(), x.size()), y_bounds = spreadOf(y.data(), y.size());
  const double margin = static_cast<double>(margin_) * cell_, per_meter = 1 / cell_;
  // The grid is aligned to multiples of the cell side, so that it does not depend on the outermost
  // return.
  x0_ = std::floor(static_cast<double>(x_bounds.lowest) / cell_) * cell_ - margin;
  y0_ = std::floor(static_cast<double>(y_bounds.lowest) / cell_) * cell_ - margin;
  columns_ =
      static_cast<std::size_t>((static_cast<double>(x_bounds.highest) - x0_) / cell_) + 1 + margin_;
  rows_ =
      static_cast<std::size_t>((static_cast<double>(y_bounds.highest) - y0_) / cell_) + 1 + margin_;

  cell_of_return_.resize(x.size());
  findCells(x.data(), y.data(), x.size(), x0_, y0_, per_meter, static_cast<std::int32_t>(columns_),
            cell_of_return_.data());
  weights_ = std::vector<float>(columns_ * rows_);  // zeros, faster than assign()
  for (std::size_t i = 0; i < x.size(); ++i) {
    float& sum = weights_[cell_of_return_[i]];
    const float more = weight.empty() ? 1.0f : weight[i];
    if (sum == 0 && more > 0) occupied_.push_back(cell_of_return_[i]);
    sum += more;
  }
}

namespace {

/// The kernel's rows, zero-padded to multiples of eight.
struct KernelRows {
  struct Row {
    std::ptrdiff_t offset;  ///< grid offset of its first cell from the center
    std::size_t first;      ///< index into `weights`
    std::size_t eights;     ///< length in groups of eight
  };
  KernelRows(std::size_t columns, const PersonParams& params);
  std::vector<float> weights;
  std::vector<Row> rows;
};

KernelRows::KernelRows(std::size_t columns, const PersonParams& params) {
  const auto reach = static_cast<std::ptrdiff_t>(params.support / params.cell);
  for (std::ptrdiff_t row = -reach; row <= reach; ++row) {
    const double dy = static_cast<double>(row) * params.cell;
    const auto half = static_cast<std::ptrdiff_t>(
        std::sqrt(params.support * params.support - dy * dy) / params.cell);
    Row line{row * static_cast<std::ptrdiff_t>(columns) - half, weights.size(), 0};
    for (std::ptrdiff_t column = -half; column <= half; ++column)
      weights.push_back(static_cast<float>(
          personKernel(std::hypot(static_cast<double>(column) * params.cell, dy), params)));
    while ((weights.size() - line.first) % 8 != 0) weights.push_back(0);
    line.eights = (weights.size() - line.first) / 8;
    rows.push_back(line);
  }
}

/// Adds `weight` times the kernel about a cell.
PERCEPTION_WIDER void addKernel(const KernelRows& kernel, float weight, float* cell) {
  for (const KernelRows::Row& row : kernel.rows) {
    float* out = cell + row.offset;
    const float* in = kernel.weights.data() + row.first;
    for (std::size_t eight = 0; eight < row.eights; ++eight, out += 8, in += 8)
      for (std::size_t i = 0; i < 8; ++i) out[i] += weight * in[i];
  }
}

}  // namespace

/// Adds, for every cell with returns, its weight times the kernel to the cells around it.
void PersonResponse::scatter(const PersonParams& params) {
  const KernelRows kernel(columns_, params);
  response_ = std::vector<float>(columns_ * rows_);
  for (const std::uint32_t k : occupied_) addKernel(kernel, weights_[k], response_.data() + k);
}

bool PersonResponse::isMaximum(std::size_t k) const {
  const float here = response_[k];
  bool beside_returns = false;
  for (std::size_t row = k - columns_; row <= k + columns_; row += columns_)
    for (std::size_t near = row - 1; near <= row + 1; ++near) {
      if (response_[near] > here || (near < k && response_[near] == here)) return false;
      beside_returns = beside_returns || weights_[near] > 0;
    }
  return beside_returns;
}

std::vector<std::uint32_t> PersonResponse::maxima(float least) const {
  std::vector<std::uint32_t> found;
  constexpr std::size_t kGroup = 16;
  const std::size_t first = columns_ + 1, last = response_.size() - columns_ - 1;
  for (std::size_t begin = first; begin < last; begin += kGroup) {
    begin = firstGroupWith(response_.data(), begin, last, least);
    const std::size_t end = std::min(begin + kGroup, last);
    for (std::size_t k = begin; k < end; ++k)
      if (response_[k] >= least && isMaximum(k)) found.push_back(static_cast<std::uint32_t>(k));
  }
  return found;
}

}  // namespace perception
