#pragma once
#include <vector>

#include "libperception/core/Random.h"
#include "libperception/filter/LikelihoodTable.h"

namespace perception {

/// How a hypothesis chooses the causes of a scan's measurements. [run] association.
enum class Proposal {
  kSampled,  ///< drawn measurement by measurement from the exact conditional (the paper's optimal
             ///< proposal, SPEC 5.4)
};

/// For one hypothesis: the cause of every measurement, and what that does to the hypothesis's
/// weight.
struct Association {
  static constexpr int kNew = -1;  ///< birth or clutter: a Bernoulli newborn
  std::vector<int> cause;          ///< by measurement: index into the hypothesis's tracks, or kNew
  double log_weight = 0;           ///< log p(scan | history) / proposal, exact
};

/// The table turned by measurement: who could have caused it. Shared by all hypotheses of a scan.
class AssociationIndex {
 public:
  AssociationIndex(const std::vector<Track>& predicted, const LikelihoodTable& table);

  struct Candidate {
    std::size_t track;  ///< index into the distinct tracks
    double log_odds;    ///< log r + lhat - log(1 - r P_D)
  };
  const std::vector<Candidate>& candidates(std::size_t measurement) const {
    return by_measurement_[measurement];
  }
  double logMiss(std::size_t track) const { return log_miss_[track]; }  ///< log(1 - r P_D)
  double logNew(std::size_t measurement) const { return log_new_[measurement]; }
  std::size_t measurements() const { return by_measurement_.size(); }
  std::size_t tracks() const { return log_miss_.size(); }

 private:
  std::vector<std::vector<Candidate>> by_measurement_;
  std::vector<double> log_miss_, log_new_;
};

/// Pass 3 for one hypothesis, table look-ups only. `tracks` are indices of the hypothesis's tracks
/// into the distinct ones; `order` is the scan's random order of measurements, the same for all
/// hypotheses.
Association associate(const std::vector<std::size_t>& tracks, const AssociationIndex& index,
                      const std::vector<std::size_t>& order, Rng rng);

/// A random permutation of 0..n-1.
std::vector<std::size_t> randomOrder(std::size_t n, Rng rng);

}  // namespace perception
