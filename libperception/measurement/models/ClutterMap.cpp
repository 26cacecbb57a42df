#include "libperception/measurement/models/ClutterMap.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Angle.h"

namespace perception {
namespace {

constexpr double kSector = radians(45), kFirstRing = 10;  // [rad], [m]; assumed
/// [s] for which counts are remembered: shorter than weather changes, longer than a junction takes.
constexpr double kMemory = 10;
/// Shape of the Gamma prior of the whole: its 90 % interval spans from a twentieth to three times
/// the configured rate.
constexpr double kPriorShape = 1;
/// Shape of the Gamma prior of a cell about its share of the whole: false measurements cluster.
constexpr double kCellShape = 8;
/// Largest factor on the configured density, either way.
constexpr double kMostLogFactor = 3.5;  // ln 33

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
  scans_ = kPriorShape / prior_rate_ + exposure_;
  setFactors();
}

void ClutterMap::setFactors() {
  for (std::size_t c = 0; c < counts_.size(); ++c) {
    const double share = cells_.share(c), mean = rate() * share;
    const double density = (kCellShape + counts_[c]) / (kCellShape / mean + exposure_);
    log_factor_[c] =
        std::clamp(std::log(density / (prior_rate_ * share)), -kMostLogFactor, kMostLogFactor);
  }
}

double ClutterMap::logSilence(double scans) const {
  return std::min(shape_, prior_rate_ * scans_) * std::log(scans_ / (scans_ + scans));
}

}  // namespace perception
