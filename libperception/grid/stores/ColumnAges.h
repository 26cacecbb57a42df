#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libperception/grid/stores/LogOddsColumn.h"

namespace perception {

/// Time since the last change of each column of a grid, and the decay since then: a byte per
/// column, the number of the scan modulo 256. refresh() updates a few columns per scan, so that
/// none gets older than 256 scans.
class ColumnAges {
 public:
  /// `tau`: [s] time constant of the decay.
  ColumnAges(std::size_t columns, double tau) : tau_(tau), scans_(columns, 0) {
    times_.fill(0), keep_.fill(1), losses_.fill(0);
  }

  /// Begins a scan, `seconds` after the last one.
  void advance(double seconds) {
    now_ += seconds;
    times_[++scan_] = now_;
    for (std::size_t i = 0; i < kRound; ++i) {
      keep_[i] = std::exp(-(now_ - times_[i]) / tau_);
      losses_[i] = LogOddsColumn::lossOf(keep_[i]);
    }
  }
  /// Calls `update` for the columns to be refreshed in this scan.
  template <class Update>
  void refresh(const Update& update) {
    constexpr std::size_t kScans = kRound - 16;  // within which all columns are refreshed
    for (std::size_t left = scans_.size() / kScans + 1; left > 0; --left) {
      next_ = next_ + 1 < scans_.size() ? next_ + 1 : 0;
      update(next_);
    }
  }
  void touch(std::size_t column) { scans_[column] = scan_; }
  void touchAll() { scans_.assign(scans_.size(), scan_); }

  /// Factor of decay of a column since its last change.
  double keep(std::size_t column) const { return keep_[scans_[column]]; }
  /// The loss, 1 - keep(), for LogOddsColumn::update().
  std::int16_t loss(std::size_t column) const { return losses_[scans_[column]]; }
  std::size_t memoryBytes() const { return scans_.capacity() + sizeof *this; }

 private:
  static constexpr std::size_t kRound = 256;  // number of values of a byte

  double tau_, now_ = 0;              // [s]
  std::uint8_t scan_ = 0;             // the last one
  std::array<double, kRound> times_;  // [s] of the scans of a round
  std::array<double, kRound> keep_;   // factor of decay since then
  std::array<std::int16_t, kRound> losses_;
  std::vector<std::uint8_t> scans_;  // scan of the last change of each column
  std::size_t next_ = 0;             // next column to refresh
};

}  // namespace perception
