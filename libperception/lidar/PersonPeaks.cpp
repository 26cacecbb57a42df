#include "libperception/lidar/PersonPeaks.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace perception {

void PersonParams::visit(ParamVisitor& v) {
  v.real("cell", cell, {0.05, 1}, "m", "of the grid (paper)");
  v.real("sigma", sigma, {0.1, 2}, "m", "of the Gaussian (paper)");
  v.real("support", support, {0.5, 10}, "m", "radius beyond which the kernel counts as zero");
  v.choiceOf("kernel", kernel, {"consistent", "printed"},
             "second term with sigma^4, or sigma^2 as the paper prints it");
  v.real("threshold", threshold, {0, 10}, "1/m^2", "response per return near the peak");
  v.real("radius", radius, {0.1, 3}, "m", "about the peak: the person's returns");
  v.integer("min_points", min_points, {1, 1000}, "returns within radius");
  v.real("min_span", min_span, {0, 3}, "m", "least height from lowest to highest return");
  v.real("max_span", max_span, {0.5, 5}, "m", "largest height from lowest to highest return");
  v.real("separation", separation, {0, 5}, "m", "radius of non-maximum suppression");
  v.real("hull_margin", hull_margin, {0, 3}, "m",
         "about accepted clusters in which peaks compete with them");
  v.real("whole_share", whole_share, {0, 1}, "",
         "of a cluster's returns in a peak: the cluster is a person");
  v.real("part_share", part_share, {0, 1}, "",
         "of a rider-sized cluster's returns in a peak: the peak is the middle of one object");
  v.real("rider_size", rider_size, {0, 10}, "m", "longest side of a rider-sized cluster");
  v.real("crowd_threshold", crowd_threshold, {0, 10}, "1/m^2",
         "normalised response that counts beside something unstable");
}

double personKernel(double r, const PersonParams& params) {
  const double s2 = params.sigma * params.sigma, u = r * r / (2 * s2);
  const double fourth = params.kernel == PersonParams::Kernel::kPrinted
                            ? r * r * u
                            : 2 * u * u;  // r^4 / (2 s^2), r^4 / (2 s^4)
  return std::exp(-u) / (kPi * s2) * ((1 - u) + 0.15 * (1 - fourth));
}

namespace {

/// Returns counted in square cells, with the filter's response at every cell's centre.
class ResponseGrid {
 public:
  ResponseGrid(const std::vector<float>& x, const std::vector<float>& y,
               const PersonParams& params);

  std::size_t columns() const { return columns_; }
  std::size_t rows() const { return rows_; }
  float at(std::size_t column, std::size_t row) const { return response_[row * columns_ + column]; }
  Vector2 centre(std::size_t column, std::size_t row) const {
    return {x0_ + (static_cast<double>(column) + 0.5) * cell_,
            y0_ + (static_cast<double>(row) + 0.5) * cell_};
  }
  /// Cells that hold returns, in the order of the grid.
  const std::vector<std::uint32_t>& occupied() const { return occupied_; }
  /// The returns within `radius` of `place`, in the scan's order.
  std::vector<std::uint32_t> within(const Vector2& place, double radius,
                                    const std::vector<float>& x, const std::vector<float>& y) const;

 private:
  void scatter(const std::vector<std::uint32_t>& counts, const PersonParams& params);

  double cell_, x0_ = 0, y0_ = 0;
  std::size_t margin_, columns_ = 0, rows_ = 0;
  std::vector<float> response_;
  std::vector<std::uint32_t> start_, points_, occupied_;
};

ResponseGrid::ResponseGrid(const std::vector<float>& x, const std::vector<float>& y,
                           const PersonParams& params)
    : cell_(params.cell),
      margin_(static_cast<std::size_t>(std::ceil(params.support / params.cell)) + 1) {
  if (x.empty()) return;
  const auto [x_low, x_high] = std::minmax_element(x.begin(), x.end());
  const auto [y_low, y_high] = std::minmax_element(y.begin(), y.end());
  const double margin = static_cast<double>(margin_) * cell_;
  // Cells lie on multiples of their side, so that they do not depend on which return is the
  // outermost.
  x0_ = std::floor(static_cast<double>(*x_low) / cell_) * cell_ - margin;
  y0_ = std::floor(static_cast<double>(*y_low) / cell_) * cell_ - margin;
  columns_ = static_cast<std::size_t>((static_cast<double>(*x_high) - x0_) / cell_) + 1 + margin_;
  rows_ = static_cast<std::size_t>((static_cast<double>(*y_high) - y0_) / cell_) + 1 + margin_;

  std::vector<std::uint32_t> cell_of(x.size());
  std::vector<std::uint32_t> counts(columns_ * rows_, 0);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const auto column = static_cast<std::size_t>((static_cast<double>(x[i]) - x0_) / cell_);
    const auto row = static_cast<std::size_t>((static_cast<double>(y[i]) - y0_) / cell_);
    cell_of[i] = static_cast<std::uint32_t>(row * columns_ + column);
    ++counts[cell_of[i]];
  }
  start_.resize(counts.size() + 1, 0);
  for (std::size_t k = 0; k < counts.size(); ++k) {
    start_[k + 1] = start_[k] + counts[k];
    if (counts[k] > 0) occupied_.push_back(static_cast<std::uint32_t>(k));
  }
  points_.resize(x.size());
  std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
  for (std::size_t i = 0; i < x.size(); ++i)
    points_[next[cell_of[i]]++] = static_cast<std::uint32_t>(i);
  scatter(counts, params);
}

/// Every occupied cell adds its count times the kernel to the cells around it, row by row.
void ResponseGrid::scatter(const std::vector<std::uint32_t>& counts, const PersonParams& params) {
  const auto reach = static_cast<std::ptrdiff_t>(params.support / cell_);
  struct Row {
    std::ptrdiff_t offset;  ///< of its first cell from the centre, in the grid
    std::vector<float> weights;
  };
  std::vector<Row> kernel;
  for (std::ptrdiff_t row = -reach; row <= reach; ++row) {
    const double dy = static_cast<double>(row) * cell_;
    const auto half =
        static_cast<std::ptrdiff_t>(std::sqrt(params.support * params.support - dy * dy) / cell_);
    Row line{row * static_cast<std::ptrdiff_t>(columns_) - half, {}};
    for (std::ptrdiff_t column = -half; column <= half; ++column)
      line.weights.push_back(static_cast<float>(
          personKernel(std::hypot(static_cast<double>(column) * cell_, dy), params)));
    kernel.push_back(std::move(line));
  }
  response_.assign(columns_ * rows_, 0);
  for (const std::uint32_t k : occupied_) {
    const auto count = static_cast<float>(counts[k]);
    for (const Row& line : kernel) {
      float* out = response_.data() + static_cast<std::ptrdiff_t>(k) + line.offset;
      for (std::size_t i = 0; i < line.weights.size(); ++i) out[i] += count * line.weights[i];
    }
  }
}

std::vector<std::uint32_t> ResponseGrid::within(const Vector2& place, double radius,
                                                const std::vector<float>& x,
                                                const std::vector<float>& y) const {
  std::vector<std::uint32_t> found;
  const auto clampTo = [](double value, std::size_t count) {
    return static_cast<std::size_t>(std::clamp(value, 0.0, static_cast<double>(count - 1)));
  };
  const std::size_t left = clampTo((place.x() - radius - x0_) / cell_, columns_);
  const std::size_t right = clampTo((place.x() + radius - x0_) / cell_, columns_);
  const std::size_t bottom = clampTo((place.y() - radius - y0_) / cell_, rows_);
  const std::size_t top = clampTo((place.y() + radius - y0_) / cell_, rows_);
  for (std::size_t row = bottom; row <= top; ++row)
    for (std::uint32_t p = start_[row * columns_ + left]; p < start_[row * columns_ + right + 1];
         ++p) {
      const std::uint32_t i = points_[p];
      const double dx = static_cast<double>(x[i]) - place.x(),
                   dy = static_cast<double>(y[i]) - place.y();
      if (dx * dx + dy * dy <= radius * radius) found.push_back(i);
    }
  std::sort(found.begin(), found.end());
  return found;
}

/// The peak at a cell, when its returns are person-sized.
bool describe(const ResponseGrid& grid, std::size_t column, std::size_t row,
              const std::vector<float>& x, const std::vector<float>& y,
              const std::vector<float>& height, const PersonParams& params, PersonPeak& peak) {
  peak.response = static_cast<double>(grid.at(column, row));
  peak.points = grid.within(grid.centre(column, row), params.radius, x, y);
  if (peak.points.size() < static_cast<std::size_t>(params.min_points)) return false;
  const auto count = static_cast<double>(peak.points.size());
  peak.normalised = peak.response / count;
  if (peak.normalised < params.threshold) return false;
  peak.centre = Vector2::Zero();
  peak.lowest = peak.highest = height[peak.points.front()];
  for (const std::uint32_t i : peak.points) {
    peak.centre += Vector2(static_cast<double>(x[i]), static_cast<double>(y[i])) / count;
    peak.lowest = std::min(peak.lowest, height[i]),
    peak.highest = std::max(peak.highest, height[i]);
  }
  const auto span = static_cast<double>(peak.highest - peak.lowest);
  return span >= params.min_span && span <= params.max_span;
}

/// Not below any of its eight neighbours; of equal ones the first in the grid.
bool isLocalMaximum(const ResponseGrid& grid, std::size_t column, std::size_t row) {
  const float here = grid.at(column, row);
  for (std::size_t r = row - 1; r <= row + 1; ++r)
    for (std::size_t c = column - 1; c <= column + 1; ++c) {
      const bool before = r < row || (r == row && c < column);
      if (grid.at(c, r) > here || (before && grid.at(c, r) == here)) return false;
    }
  return true;
}

}  // namespace

std::vector<PersonPeak> findPersons(const std::vector<float>& x, const std::vector<float>& y,
                                    const std::vector<float>& height, const PersonParams& params) {
  const ResponseGrid grid(x, y, params);
  // A positive maximum lies in a cell with returns or beside one.
  std::vector<std::uint8_t> looked_at(grid.columns() * grid.rows(), 0);
  std::vector<std::uint32_t> cells;
  const auto columns = static_cast<std::uint32_t>(grid.columns());
  for (const std::uint32_t k : grid.occupied())
    for (const std::uint32_t row : {k - columns, k, k + columns})
      for (const std::uint32_t near : {row - 1, row, row + 1})
        if (!std::exchange(looked_at[near], std::uint8_t{1})) cells.push_back(near);

  std::vector<PersonPeak> candidates;
  for (const std::uint32_t k : cells) {
    const std::size_t column = k % columns, row = k / columns;
    if (grid.at(column, row) <= 0 || !isLocalMaximum(grid, column, row)) continue;
    PersonPeak peak;
    if (describe(grid, column, row, x, y, height, params, peak))
      candidates.push_back(std::move(peak));
  }
  std::stable_sort(
      candidates.begin(), candidates.end(),
      [](const PersonPeak& a, const PersonPeak& b) { return a.response > b.response; });
  std::vector<PersonPeak> peaks;
  for (PersonPeak& candidate : candidates) {
    const bool alone = std::none_of(peaks.begin(), peaks.end(), [&](const PersonPeak& stronger) {
      return (stronger.centre - candidate.centre).norm() < params.separation;
    });
    if (alone) peaks.push_back(std::move(candidate));
  }
  return peaks;
}

}  // namespace perception
