#pragma once
#include <vector>

namespace perception {

/// Log-odds that a detector's 3D box is an object of its label, by score and range (method.md
/// (52)).
struct ScoreOdds {
  double offset = 0, slope = 0, fade = 0;  ///< slope (score - offset) - fade range

  double logOdds(double score, double range) const {
    return slope * (score - offset) - fade * range;
  }
};

/// A box and whether the truth has an object there.
struct BoxSample {
  double score = 0, range = 0;  ///< [-], [m]
  bool object = false;
};

/// Logistic regression of `object` on score and range by Newton's method, with a ridge penalty.
/// No samples: zeros.
ScoreOdds fitScoreOdds(const std::vector<BoxSample>& samples, double ridge = 10);
/// Mean negative log-likelihood of the samples.
double logLoss(const ScoreOdds& odds, const std::vector<BoxSample>& samples);

}  // namespace perception
