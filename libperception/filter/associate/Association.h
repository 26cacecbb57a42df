#pragma once
#include <vector>

#include "libperception/core/math/Random.h"
#include "libperception/filter/likelihood/LikelihoodTable.h"

namespace perception {

/// The tracks of one hypothesis, as indices into the scan's distinct tracks.
using TrackIndices = std::vector<std::uint32_t>;

/// The association of one hypothesis: the cause of every measurement, and the increment of the
/// hypothesis's log weight.
struct Association {
  static constexpr int kNew =
      -1;  ///< a newborn: Bernoulli track of birth or clutter; with sampled births, a birth
  static constexpr int kClutter = -2;  ///< with sampled births only
  std::vector<int> cause;  ///< by measurement: index of a distinct track, kNew or kClutter
  double log_weight = 0;   ///< log p(scan | history) / proposal, exact
};

/// The likelihood table by measurement: its candidate causes. Shared by all hypotheses of a scan.
class AssociationIndex {
 public:
  AssociationIndex(const std::vector<Track>& predicted, const LikelihoodTable& table,
                   const FilterModel& model);

  struct Candidate {
    std::size_t track;  ///< index into the distinct tracks
    double log_odds;    ///< log r + lhat - log(1 - r P_D)
  };
  /// A cause other than a track: newborn or clutter.
  struct Other {
    int cause;
    double log_weight;
  };
  const std::vector<Candidate>& candidates(std::size_t measurement) const {
    return by_measurement_[measurement];
  }
  const std::vector<Other>& others(std::size_t measurement) const { return others_[measurement]; }
  double logMiss(std::size_t track) const { return log_miss_[track]; }  ///< log(1 - r P_D)
  std::size_t measurements() const { return by_measurement_.size(); }
  std::size_t tracks() const { return log_miss_.size(); }

 private:
  std::vector<std::vector<Candidate>> by_measurement_;
  std::vector<std::vector<Other>> others_;
  std::vector<double> log_miss_;
};

/// An association sampled by one or more slots of one hypothesis.
struct SampledAssociation {
  Association association;
  std::vector<std::uint32_t> slots;  ///< ascending
};

/// Pass 3 for one hypothesis and the slots that hold it: each slot samples the cause of one
/// measurement after the other from the exact conditional, the optimal proposal of [radecki2016]
/// (method.md 5.4), by table look-up. Slots with equal samples so far share the work, and their
/// draws are stratified with the stream of `key` of the first one. `tracks` are indices of the
/// hypothesis's tracks into the distinct ones; `order` is the scan's random order of measurements,
/// the same for all hypotheses; `slots` are ascending and not empty.
std::vector<SampledAssociation> sampleAssociations(const TrackIndices& tracks,
                                                   const AssociationIndex& index,
                                                   const std::vector<std::size_t>& order,
                                                   std::vector<std::uint32_t> slots,
                                                   const RngKey& key);

/// A random permutation of 0..n-1.
std::vector<std::size_t> randomOrder(std::size_t n, Rng rng);

}  // namespace perception
