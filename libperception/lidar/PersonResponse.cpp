#include "libperception/lidar/PersonResponse.h"

#include <algorithm>
#include <cmath>

#include "libperception/lidar/EgoPoints.h"
#include "libperception/lidar/PersonPeaks.h"

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
      // Rows of the kernel are padded by up to seven cells to the right.
      margin_(static_cast<std::size_t>(std::ceil(params.support / params.cell)) + 8) {
  if (x.empty()) return;
  place(x, y, weight);
  scatter(params);
}

void PersonResponse::place(const std::vector<float>& x, const std::vector<float>& y,
                           const std::vector<float>& weight) {
  const auto [x_low, x_high] = std::minmax_element(x.begin(), x.end());
  const auto [y_low, y_high] = std::minmax_element(y.begin(), y.end());
  const double margin = static_cast<double>(margin_) * cell_, per_metre = 1 / cell_;
  // Cells lie on multiples of their side, so that they do not depend on which return is the
  // outermost.
  x0_ = std::floor(static_cast<double>(*x_low) / cell_) * cell_ - margin;
  y0_ = std::floor(static_cast<double>(*y_low) / cell_) * cell_ - margin;
  columns_ = static_cast<std::size_t>((static_cast<double>(*x_high) - x0_) / cell_) + 1 + margin_;
  rows_ = static_cast<std::size_t>((static_cast<double>(*y_high) - y0_) / cell_) + 1 + margin_;

  const double x0 = x0_, y0 = y0_;
  const auto columns = static_cast<std::int32_t>(columns_);
  cell_of_return_.resize(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const auto column = static_cast<std::int32_t>((static_cast<double>(x[i]) - x0) * per_metre);
    const auto row = static_cast<std::int32_t>((static_cast<double>(y[i]) - y0) * per_metre);
    cell_of_return_[i] = static_cast<std::uint32_t>(row * columns + column);
  }
  weights_.assign(columns_ * rows_, 0);
  for (std::size_t i = 0; i < x.size(); ++i) {
    float& sum = weights_[cell_of_return_[i]];
    const float more = weight.empty() ? 1.0f : weight[i];
    if (sum == 0 && more > 0) occupied_.push_back(cell_of_return_[i]);
    sum += more;
  }
}

namespace {

/// The kernel's rows, padded with zeros to multiples of eight: whole vectors.
struct KernelRows {
  struct Row {
    std::ptrdiff_t offset;  ///< of its first cell from the centre, in the grid
    std::size_t first;      ///< place in `weights`
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

/// Every cell with returns adds its weight times the kernel to the cells around it.
void PersonResponse::scatter(const PersonParams& params) {
  const KernelRows kernel(columns_, params);
  response_.assign(columns_ * rows_, 0);
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
    const std::size_t end = std::min(begin + kGroup, last);
    std::int32_t any = 0;
    for (std::size_t k = begin; k < end; ++k) any |= response_[k] >= least;
    if (any == 0) continue;
    for (std::size_t k = begin; k < end; ++k)
      if (response_[k] >= least && isMaximum(k)) found.push_back(static_cast<std::uint32_t>(k));
  }
  return found;
}

}  // namespace perception
