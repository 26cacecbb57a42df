#include "libperception/calibration/clusters/Isotonic.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

#include "libperception/core/Error.h"

namespace perception {
namespace {

constexpr double kLeastMean = 0.002, kMostMean = 0.995;
constexpr std::size_t kMostSteps = 32;

/// A step of the map.
struct Step {
  double first, last;   ///< raw probabilities
  double weight, mean;  ///< of the samples; share of the class in it
};

Step joined(const Step& a, const Step& b) {
  const double weight = a.weight + b.weight;
  const auto [low, high] = std::minmax(a.mean, b.mean);
  const double mean = (a.weight * a.mean + b.weight * b.mean) / weight;
  return {a.first, b.last, weight, std::clamp(mean, low, high)};
}

/// The samples by value, those of equal value as one.
std::vector<Step> sorted(const std::vector<double>& values, const std::vector<bool>& is_class,
                         const std::vector<double>& weights) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  std::vector<Step> steps;
  for (const std::size_t i : order) {
    if (!(weights[i] > 0)) continue;
    const Step step{values[i], values[i], weights[i], is_class[i] ? 1.0 : 0.0};
    if (!steps.empty() && !(steps.back().last < step.first))
      steps.back() = joined(steps.back(), step);
    else
      steps.push_back(step);
  }
  return steps;
}

/// Joins neighbors until every step is higher than the one before.
std::vector<Step> pooled(const std::vector<Step>& steps) {
  std::vector<Step> out;
  for (const Step& step : steps) {
    out.push_back(step);
    while (out.size() > 1 && out[out.size() - 2].mean >= out.back().mean) {
      const Step last = out.back();
      out.pop_back();
      out.back() = joined(out.back(), last);
    }
  }
  return out;
}

/// Increase of the sum of squares if two steps become one.
double cost(const Step& a, const Step& b) {
  const double rise = b.mean - a.mean;
  return a.weight * b.weight / (a.weight + b.weight) * rise * rise;
}

void reduce(std::vector<Step>& steps) {
  while (steps.size() > kMostSteps) {
    std::size_t best = 1;
    for (std::size_t i = 2; i < steps.size(); ++i)
      if (cost(steps[i - 1], steps[i]) < cost(steps[best - 1], steps[best])) best = i;
    steps[best - 1] = joined(steps[best - 1], steps[best]);
    steps.erase(steps.begin() + static_cast<std::ptrdiff_t>(best));
  }
}

}  // namespace

std::vector<Knot> isotonic(const std::vector<double>& values, const std::vector<bool>& is_class,
                           const std::vector<double>& weights) {
  if (values.size() != is_class.size() || values.size() != weights.size())
    throw Error(ExitCode::kInternal, "isotonic: sizes differ");
  std::vector<Step> steps = pooled(sorted(values, is_class, weights));
  for (Step& step : steps) step.mean = std::clamp(step.mean, kLeastMean, kMostMean);
  steps = pooled(steps);  // what the limits made equal
  reduce(steps);
  std::vector<Knot> knots;
  for (const Step& step : steps) {
    knots.push_back({step.first, step.mean});
    if (step.last > step.first) knots.push_back({step.last, step.mean});
  }
  return knots;
}

}  // namespace perception
