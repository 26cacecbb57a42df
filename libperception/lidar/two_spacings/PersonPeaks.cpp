#include "libperception/lidar/two_spacings/PersonPeaks.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libperception/lidar/two_spacings/PersonResponse.h"

namespace perception {

void PersonParams::visit(ParamVisitor& v) {
  v.integer("min_points", min_points, {1, 1000}, "returns within 0.45 m of the peak");
  v.real("min_span", min_span, {0, 3}, "m", "least height from lowest to highest return");
  v.expert();
  v.choiceOf("kernel", kernel, {"consistent", "printed"},
             "second term with sigma^4, or with sigma^2 as printed in Radecki et al.");
  v.real("threshold", threshold, {0, 10}, "1/m^2", "response per return near the peak");
}

namespace {

/// The returns in the cells about some positions, cell by cell.
class Neighborhoods {
 public:
  /// Square blocks that extend `reach` cells to each side of `middles`.
  Neighborhoods(const PersonResponse& response, const std::vector<std::uint32_t>& middles,
                std::size_t reach);
  /// Calls f with each return in the block about `middle`.
  template <class Function>
  void forEach(std::uint32_t middle, const Function& f) const;

 private:
  std::size_t columns_, reach_;
  std::vector<std::uint32_t> number_;  ///< of a cell + 1; 0: in no block
  std::vector<std::uint32_t> start_, returns_;
};

Neighborhoods::Neighborhoods(const PersonResponse& response,
                             const std::vector<std::uint32_t>& middles, std::size_t reach)
    : columns_(response.columns()), reach_(reach), number_(response.values().size(), 0) {
  std::uint32_t count = 0;
  for (const std::uint32_t middle : middles)
    for (std::size_t row = middle - reach_ * columns_; row <= middle + reach_ * columns_;
         row += columns_)
      for (std::size_t k = row - reach_; k <= row + reach_; ++k)
        if (number_[k] == 0) number_[k] = ++count;
  start_.assign(count + 2, 0);
  const std::vector<std::uint32_t>& cells = response.cellOfReturn();
  for (const std::uint32_t k : cells) ++start_[number_[k]];
  start_[0] = 0;  // for returns in no block
  for (std::size_t n = 1; n < start_.size(); ++n) start_[n] += start_[n - 1];
  returns_.resize(start_[count]);
  std::vector<std::uint32_t> next(start_.begin(), start_.end());
  for (std::uint32_t i = 0; i < cells.size(); ++i)
    if (const std::uint32_t n = number_[cells[i]]; n != 0) returns_[next[n - 1]++] = i;
}

template <class Function>
void Neighborhoods::forEach(std::uint32_t middle, const Function& f) const {
  for (std::size_t row = middle - reach_ * columns_; row <= middle + reach_ * columns_;
       row += columns_)
    for (std::size_t k = row - reach_; k <= row + reach_; ++k)
      for (std::uint32_t p = start_[number_[k] - 1]; p < start_[number_[k]]; ++p) f(returns_[p]);
}

/// Drops maxima whose response per return is too low even without the cells cut by the circle:
/// walls and hedges.
void dropCrowded(const PersonResponse& response, const PersonParams& params,
                 std::vector<std::uint32_t>& maxima) {
  std::vector<std::ptrdiff_t> inside;  // cells entirely inside the circle
  const auto reach = static_cast<std::ptrdiff_t>(params.radius / params.cell);
  for (std::ptrdiff_t row = -reach; row <= reach; ++row)
    for (std::ptrdiff_t column = -reach; column <= reach; ++column)
      if (std::hypot(std::abs(static_cast<double>(row)) + 0.5,
                     std::abs(static_cast<double>(column)) + 0.5) *
              params.cell <=
          params.radius)
        inside.push_back(row * static_cast<std::ptrdiff_t>(response.columns()) + column);
  const auto crowded = [&](std::uint32_t k) {
    double weight = 0;
    for (const std::ptrdiff_t offset : inside)
      weight += static_cast<double>(
          response.weights()[static_cast<std::size_t>(static_cast<std::ptrdiff_t>(k) + offset)]);
    return static_cast<double>(response.values()[k]) < params.threshold * (1 - 1e-5) * weight;
  };
  maxima.erase(std::remove_if(maxima.begin(), maxima.end(), crowded), maxima.end());
}

/// Describes the peak at a cell; false unless its returns are person-sized.
bool describe(const PersonResponse& response, const Neighborhoods& near, std::uint32_t cell,
              const std::vector<float>& x, const std::vector<float>& y,
              const std::vector<float>& height, const std::vector<float>& weight,
              const PersonParams& params, PersonPeak& peak) {
  const Vector2 center = response.center(cell);
  near.forEach(cell, [&](std::uint32_t i) {
    const double dx = static_cast<double>(x[i]) - center.x(),
                 dy = static_cast<double>(y[i]) - center.y();
    if (dx * dx + dy * dy <= params.radius * params.radius) peak.points.push_back(i);
  });
  if (peak.points.empty()) return false;
  std::sort(peak.points.begin(), peak.points.end());
  peak.response = static_cast<double>(response.values()[cell]);
  peak.lowest = peak.highest = height[peak.points.front()];
  for (const std::uint32_t i : peak.points) {
    const double w = weight.empty() ? 1.0 : static_cast<double>(weight[i]);
    peak.weight += w;
    peak.center += w * Vector2(static_cast<double>(x[i]), static_cast<double>(y[i]));
    peak.lowest = std::min(peak.lowest, height[i]);
    peak.highest = std::max(peak.highest, height[i]);
  }
  if (peak.weight < params.min_points - 1e-6) return false;
  peak.center /= peak.weight;
  peak.normalized = peak.response / peak.weight;
  const auto span = static_cast<double>(peak.highest - peak.lowest);
  return peak.normalized >= params.threshold && span >= params.min_span && span <= params.max_span;
}

/// Whether the returns have the shape of an upright person: width of shoulders, height of a person,
/// no vertical gaps as in twigs. Sets width and gap.
bool hasShape(const std::vector<float>& x, const std::vector<float>& y,
              const std::vector<float>& height, const PersonParams& params, const Vector2& sensor,
              PersonPeak& peak) {
  const Vector2 sight = peak.center - sensor;
  const double range = std::max(sight.norm(), 1e-6);
  const Vector2 across(-sight.y() / range, sight.x() / range);
  std::vector<float> heights;
  double sum = 0, squares = 0;
  for (const std::uint32_t i : peak.points) {
    const double off =
        across.dot(Vector2(static_cast<double>(x[i]), static_cast<double>(y[i])) - peak.center);
    sum += off, squares += off * off;
    heights.push_back(height[i]);
  }
  const auto count = static_cast<double>(peak.points.size());
  peak.width = std::sqrt(12 * std::max(0.0, squares / count - sum * sum / (count * count)));
  std::sort(heights.begin(), heights.end());
  for (std::size_t i = 1; i < heights.size(); ++i)
    peak.gap = std::max(peak.gap, static_cast<double>(heights[i] - heights[i - 1]));

  const bool narrow = peak.points.size() >= static_cast<std::size_t>(params.width_points) &&
                      peak.width < params.min_width;
  return !narrow && static_cast<double>(peak.highest) <= params.max_top &&
         static_cast<double>(peak.lowest) <= params.max_bottom &&
         peak.gap <= std::max(params.max_gap, params.gap_angle * range);
}

}  // namespace

std::vector<PersonPeak> findPersons(const std::vector<float>& x, const std::vector<float>& y,
                                    const std::vector<float>& height, const PersonParams& params,
                                    const std::vector<float>& weight, const Vector2& sensor) {
  std::vector<PersonPeak> peaks;
  if (x.empty()) return peaks;
  const PersonResponse response(x, y, weight, params);
  // Least response: min_points returns at the threshold; any positive one when the threshold is
  // zero.
  const double least = std::max(params.threshold * params.min_points * (1 - 1e-3), 1e-6);
  std::vector<std::uint32_t> maxima = response.maxima(static_cast<float>(least));
  dropCrowded(response, params, maxima);
  const auto reach = static_cast<std::size_t>(std::lround(params.radius / params.cell));
  const Neighborhoods near(response, maxima, std::min(reach, response.margin() - 1));

  std::vector<PersonPeak> candidates;
  for (const std::uint32_t cell : maxima) {
    PersonPeak peak;
    if (describe(response, near, cell, x, y, height, weight, params, peak) &&
        hasShape(x, y, height, params, sensor, peak))
      candidates.push_back(std::move(peak));
  }
  std::stable_sort(
      candidates.begin(), candidates.end(),
      [](const PersonPeak& a, const PersonPeak& b) { return a.response > b.response; });
  for (PersonPeak& candidate : candidates) {
    const bool alone = std::none_of(peaks.begin(), peaks.end(), [&](const PersonPeak& stronger) {
      return (stronger.center - candidate.center).norm() < params.separation;
    });
    if (alone) peaks.push_back(std::move(candidate));
  }
  return peaks;
}

}  // namespace perception
