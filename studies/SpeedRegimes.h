#pragma once
#include <array>
#include <vector>

#include "libperception/core/Frames.h"

namespace perception {

/// How fast objects of a class go and how they change it, second by second: a Markov chain over
/// speed bins, learned from tracks. Stops, cruising and stop-and-go are all in its transitions; a
/// Gaussian of white acceleration knows none of them.
class SpeedRegimes {
 public:
  static constexpr int kBins = 16;

  /// Bin of each step between fixes: by distance over time.
  static std::vector<int> binsOf(const std::vector<double>& t, const std::vector<Vector2>& p);

  /// Transitions of one user's tracks of the class; users count by the square root of their
  /// lengths, so that one does not stand for all.
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
