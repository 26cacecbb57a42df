#pragma once
#include <cstddef>
#include <optional>

#include "libperception/core/Time.h"

namespace perception {

/// Compares the number of returns of a lidar's scans with the last seconds (method.md 9.10).
class ReturnRate {
 public:
  /// A scan: all its returns.
  void add(std::size_t returns, Stamp stamp);
  /// A scan's returns from directions in which the road lies and always returns some.
  void addRoad(std::size_t returns, Stamp stamp);

  bool empty() const { return empty_since_.has_value(); }
  /// [s] for which there was hardly a return, if that is too long for a healthy lidar; else empty.
  std::optional<double> blindFor() const;
  /// Log-likelihood ratio that the lidar has suddenly lost half of the road's returns, since the
  /// instant at which this is most likely.
  double lost() const { return lost_; }
  /// Returns of the road in the last scan as a share of the usual ones.
  double left() const { return left_; }

 private:
  double usual_ = 0;  ///< mean returns of a scan; 0: not known yet
  std::optional<Stamp> empty_since_;
  std::size_t empty_scans_ = 0;
  Stamp last_;
  // Of the road:
  double log_usual_ = 0, variance_ = 0, lost_ = 0, left_ = 1;
  std::optional<Stamp> first_road_;
  Stamp last_road_;
};

}  // namespace perception
