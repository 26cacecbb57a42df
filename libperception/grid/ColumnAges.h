#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libperception/grid/LogOddsColumn.h"

namespace perception {

/// How long ago the columns of a grid were last changed, and what they have forgotten since: a byte
/// each, the number of the scan in a round of 256. A few columns a scan are refresh()ed, so that
/// none is older than a round.
class ColumnAges {
 public:
  /// `tau`: [s] in which cells forget.
  ColumnAges(std::size_t columns, double tau) : tau_(tau), scans_(columns, 0) {
    times_.fill(0), keep_.fill(1), losses_.fill(0);
  }

  /// A scan begins, `seconds` after the last one.
  void advance(double seconds) {
    now_ += seconds;
    times_[++scan_] = now_;
    for (std::size_t i = 0; i < kRound; ++i) {
      keep_[i] = std::exp(-(now_ - times_[i]) / tau_);
      losses_[i] = LogOddsColumn::lossOf(keep_[i]);
    }
  }
  /// Calls `update` for the columns whose turn it is to be touched by this scan.
  template <class Update>
  void refresh(const Update& update) {
    constexpr std::size_t kScans = kRound - 16;  // in which all have their turn
    for (std::size_t left = scans_.size() / kScans + 1; left > 0; --left) {
      next_ = next_ + 1 < scans_.size() ? next_ + 1 : 0;
      update(next_);
    }
  }
  void touch(std::size_t column) { scans_[column] = scan_; }
  void touchAll() { scans_.assign(scans_.size(), scan_); }

  /// Share of its log-odds that a column has kept since its last change.
  double keep(std::size_t column) const { return keep_[scans_[column]]; }
  /// What it has lost, for LogOddsColumn::update().
  std::int16_t loss(std::size_t column) const { return losses_[scans_[column]]; }
  std::size_t memoryBytes() const { return scans_.capacity() + sizeof *this; }

 private:
  static constexpr std::size_t kRound = 256;  // values of a byte

  double tau_, now_ = 0;              // [s]
  std::uint8_t scan_ = 0;             // the last one
  std::array<double, kRound> times_;  // [s] of the scans of a round
  std::array<double, kRound> keep_;   // since then
  std::array<std::int16_t, kRound> losses_;
  std::vector<std::uint8_t> scans_;  // in which each column was last touched
  std::size_t next_ = 0;             // to be refreshed
};

}  // namespace perception
