#pragma once
#include <cstddef>
#include <vector>

#include "libperception/measurement/models/DetectionModel.h"

namespace perception {

/// Cells of a sensor's view by range and bearing: sectors of at most 45 degrees, rings that double
/// in width with the range.
class ViewCells {
 public:
  explicit ViewCells(const DetectionParams& params);

  std::size_t size() const { return sectors_ * rings_.size(); }
  /// Of a place at `range` [m] and `bearing` [rad] off the sensor's forward axis; places beyond the
  /// view are in the nearest cell.
  std::size_t at(double range, double bearing) const;
  /// [0, 1] of the area of the view.
  double share(std::size_t cell) const;

 private:
  double fov_, range_min_;
  std::size_t sectors_;
  std::vector<double> rings_;  ///< [m] outer radii
};

/// Expected number of false measurements per scan of one sensor, by cell of its view, learned from
/// scans whose clutter has become known: Gamma-Poisson with forgetting, first for the whole view
/// about the configured rate or a tenth or ten times of it, then for each cell about its share of
/// the whole (method.md 5.18).
class ClutterMap {
 public:
  /// `params`: clutter_per_scan and the view.
  explicit ClutterMap(const DetectionParams& params);

  const ViewCells& cells() const { return cells_; }
  /// A scan: expected false measurements by cell (cells().size() of them), `dt` [s] after the one
  /// before it.
  void add(const std::vector<double>& clutter, double dt);
  /// [1/scan] posterior mean of the whole view.
  double rate() const { return shape_ / scans_; }
  /// Log of the density at a cell over that of the configured rate, which is uniform.
  double logFactor(std::size_t cell) const { return log_factor_[cell]; }
  /// Log probability that `scans` scans hold no false measurement, at most the configured rate.
  double logSilence(double scans) const;

 private:
  void setFactors();

  ViewCells cells_;
  double prior_rate_;
  double shape_, scans_;        ///< of the rate of the whole view: counts, and scans of that mean
  double exposure_ = 0;         ///< scans that are remembered
  std::vector<double> counts_;  ///< remembered clutter by cell
  std::vector<double> log_factor_;
};

}  // namespace perception
