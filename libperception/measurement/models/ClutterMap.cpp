#include "libperception/measurement/models/ClutterMap.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libperception/core/math/Angle.h"

namespace perception {
namespace {

constexpr double kSector = radians(45), kFirstRing = 10;  // [rad], [m]; assumed
/// [s] for which counts are remembered: shorter than weather changes, longer than a junction takes.
constexpr double kMemory = 10;
/// Shape of the Gamma priors of the whole.
constexpr double kPriorShape = 1;
/// How wrong the configured rate may be: the prior is a mixture of Gamma distributions about these
/// multiples of it; its mean is the configured rate. Assumed.
struct Multiple {
  double factor, weight;
};
constexpr std::array<Multiple, 3> kMultiples{{{0.1, 0.5}, {1, 0.45}, {10, 0.05}}};
/// Shape of the Gamma prior of a cell about its share of the whole: false measurements cluster.
constexpr double kCellShape = 8;
/// Largest factor of a cell's density on the mean one of the view, either way. There is none on the
/// configured rate: with one, a rate set too low by ten could not be left in heavy clutter.
constexpr double kMostLogFactor = 3.5;  // ln 33

/// [1/scan] posterior mean of the rate after `counts` in `exposure` scans.
double posteriorMean(double prior_rate, double counts, double exposure) {
  const double shape = kPriorShape + counts;
  std::array<double, kMultiples.size()> log_evidence, mean;
  for (std::size_t k = 0; k < kMultiples.size(); ++k) {
    const double scans = kPriorShape / (prior_rate * kMultiples[k].factor);
    mean[k] = shape / (scans + exposure);
    log_evidence[k] = std::log(kMultiples[k].weight) + kPriorShape * std::log(scans) -
                      shape * std::log(scans + exposure);
  }
  const double most = *std::max_element(log_evidence.begin(), log_evidence.end());
  double all = 0, sum = 0;
  for (std::size_t k = 0; k < kMultiples.size(); ++k) {
    const double weight = std::exp(log_evidence[k] - most);
    all += weight, sum += weight * mean[k];
  }
  return sum / all;
}

}  // namespace

ViewCells::ViewCells(const DetectionParams& params)
    : fov_(std::min(params.fov, kTwoPi)),
      range_min_(params.range_min),
      sectors_(static_cast<std::size_t>(std::ceil(fov_ / kSector - 1e-9))) {
  for (double outer = std::max(kFirstRing, 2 * range_min_); outer < params.range_max; outer *= 2)
    rings_.push_back(outer);
  // A last ring of less than a half of the one before is part of it.
  if (!rings_.empty() && params.range_max < 1.5 * rings_.back()) rings_.pop_back();
  rings_.push_back(params.range_max);
}

std::size_t ViewCells::at(double range, double bearing) const {
  const auto ring = static_cast<std::size_t>(
      std::upper_bound(rings_.begin(), rings_.end() - 1, range) - rings_.begin());
  const double turn = (wrapAngle(bearing) / fov_ + 0.5) * static_cast<double>(sectors_);
  const double sector = std::clamp(std::floor(turn), 0.0, static_cast<double>(sectors_ - 1));
  return ring * sectors_ + static_cast<std::size_t>(sector);
}

double ViewCells::share(std::size_t cell) const {
  const std::size_t ring = cell / sectors_;
  const double inner = ring == 0 ? range_min_ : rings_[ring - 1], outer = rings_[ring];
  const double all = rings_.back() * rings_.back() - range_min_ * range_min_;
  return (outer * outer - inner * inner) / all / static_cast<double>(sectors_);
}

ClutterMap::ClutterMap(const DetectionParams& params)
    : cells_(params),
      prior_rate_(params.clutter_per_scan),
      shape_(kPriorShape),
      scans_(kPriorShape / prior_rate_),
      counts_(cells_.size(), 0),
      log_factor_(cells_.size(), 0) {}

void ClutterMap::add(const std::vector<double>& clutter, double dt) {
  const double keep = std::exp(-std::max(0.0, dt) / kMemory);
  exposure_ = keep * exposure_ + 1;
  double total = 0;
  for (std::size_t c = 0; c < counts_.size(); ++c) {
    counts_[c] = keep * counts_[c] + clutter[c];
    total += counts_[c];
  }
  shape_ = kPriorShape + total;
  scans_ = shape_ / posteriorMean(prior_rate_, total, exposure_);
  setFactors();
}

void ClutterMap::setFactors() {
  for (std::size_t c = 0; c < counts_.size(); ++c) {
    const double share = cells_.share(c), mean = rate() * share;
    const double density = (kCellShape + counts_[c]) / (kCellShape / mean + exposure_);
    log_factor_[c] = std::log(rate() / prior_rate_) +
                     std::clamp(std::log(density / mean), -kMostLogFactor, kMostLogFactor);
  }
}

double ClutterMap::logSilence(double scans) const {
  return std::min(shape_, prior_rate_ * scans_) * std::log(scans_ / (scans_ + scans));
}

}  // namespace perception
