#pragma once
#include <algorithm>
#include <limits>

#include "libperception/filter/state/Track.h"
#include "libperception/measurement/MeasurementModel.h"

namespace perception {

/// What a measurement adds to the evidence of a track's class by a sensor whose errors repeat
/// (method.md 5.6): the evidence of all views is their mean times the number of independent looks
/// that they are worth; what it was before is taken back, so that each view counts once.
class RepeatedEvidence {
 public:
  /// Not `applies()` where the model has no memory or the measurement tells no view. `epsilon`:
  /// floor of class probabilities; totals are limited to what it lets in, so that no more is taken
  /// back than was given. 0: none. Borrows all.
  RepeatedEvidence(const Track& track, const Measurement& m, const MeasurementScan& scan,
                   double epsilon = 0);

  bool applies() const { return memory_ != nullptr; }
  /// Difference of the log likelihood of class j.
  double added(std::size_t j) const;
  /// With this view: mean log likelihood of class j, and the independent looks it is of.
  double mean(std::size_t j) const;
  double views() const { return std::max(1.0, kept_ + worth_); }

 private:
  double total(double looks, double value, double best) const;

  const Measurement& m_;
  const EvidenceMemory* memory_ = nullptr;
  const EvidenceSeen* seen_ = nullptr;  ///< null: the first view
  double kept_ = 0, worth_ = 1;         ///< looks: of the views before, of this one
  double floor_ = -std::numeric_limits<double>::infinity();  ///< log epsilon
  double best_before_ = 0, best_now_ = 0;                    ///< totals of the likeliest class
};

/// Stores what a measurement said of a track that was just updated with it, or born of it.
void rememberEvidence(const Measurement& m, const MeasurementScan& scan, Track& track);

}  // namespace perception
