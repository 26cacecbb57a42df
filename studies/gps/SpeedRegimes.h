#pragma once
#include <array>
#include <vector>

#include "libperception/core/Frames.h"

namespace perception {

/// Markov chain of the speed of a class over speed bins at 1 Hz, trained on tracks. Unlike white
/// acceleration it models stops, cruising and stop-and-go.
class SpeedRegimes {
 public:
  static constexpr int kBins = 16;

  /// Speed bin of each step between fixes.
  static std::vector<int> binsOf(const std::vector<double>& t, const std::vector<Vector2>& p);

  /// Adds the transitions of one user's tracks, weighted by the square root of their number, so
  /// that no single user dominates.
  void add(const std::vector<std::vector<int>>& tracks_of_user);
  /// Smooths over neighboring bins and normalizes.
  void finish();

  /// log P(bins[from .. from + count)).
  double logLikelihood(const std::vector<int>& bins, std::size_t from, std::size_t count) const;

 private:
  using Matrix = std::array<std::array<double, kBins>, kBins>;
  Matrix counts_{};
  Matrix log_transition_{};
  std::array<double, kBins> log_start_{};
};

}  // namespace perception
