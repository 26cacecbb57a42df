#pragma once
#include <algorithm>
#include <limits>
#include <optional>

#include "libperception/filter/state/ClassValues.h"
#include "libperception/filter/state/FilterModel.h"
#include "libperception/filter/state/Track.h"
#include "libperception/measurement/models/MeasurementModel.h"

namespace perception {

/// Evidence of a track's class at one instant, from a sensor whose errors repeat.
struct Look {
  const EvidenceMemory* memory = nullptr;  ///< never null
  EvidenceView view;
  ClassValues said;    ///< log likelihood by class
  double phantom = 0;  ///< log likelihood of a phantom over that of anything else
  double weight = 1;   ///< below 1: a part of the object was in view, and `said` is of that part
};

/// Of a measurement taken for the track, or born from: its evidence by the shape, or, of a sensor
/// with a lookMemory(), detection, label and score. Empty: the sensor has no memory.
std::optional<Look> lookOf(const Track& track, const Measurement& m, const MeasurementScan& scan,
                           const ClassValues& detection);
/// The same. In clear air, what a shape of many returns says for a vehicle counts more from the
/// second look on, since the shape model is too careful there, and of few returns less for a
/// pedestrian who does not surely walk (method.md 5.6).
std::optional<Look> weighedLookOf(const Track& track, const Measurement& m,
                                  const MeasurementScan& scan, const ClassValues& detection,
                                  const ClassTable& classes);
/// Of a missed detection; `visible`: share of the object that nothing hides. Empty also where that
/// is nothing.
std::optional<Look> missedLook(const Track& track, const MeasurementScan& scan,
                               const ClassValues& detection, double visible);
/// P_D by class where a measurement would start an object, nothing hidden; 0: it cannot.
ClassValues detectionAtBirth(const Measurement& m, const MeasurementScan& scan,
                             const FilterModel& model);

/// What a look adds to the evidence of a track's class by a sensor whose errors repeat (method.md
/// 5.6): the evidence of all looks is their mean times the number of independent ones that they are
/// worth; the former total is taken back, so that each look counts once.
class RepeatedEvidence {
 public:
  /// `epsilon`: floor of class probabilities; totals are limited to what it lets in, so that no
  /// more is taken back than was given. 0: none. Borrows the track.
  RepeatedEvidence(const Track& track, Look look, const MeasurementScan& scan, double epsilon = 0);

  /// Difference of the log likelihood of class j.
  double added(std::size_t j) const;
  /// With this look: mean log likelihood of class j, and the independent looks it is of.
  double mean(std::size_t j) const;
  /// The same of a phantom over anything else.
  double phantomAdded() const;
  double phantomMean() const { return mean(look_.phantom, seen_ ? seen_->phantom : 0); }
  double views() const { return std::max(1.0, kept_ + worth_ * look_.weight); }
  /// With this look: mean number of returns of the looks.
  double returns() const;

 private:
  double mean(double said, double before) const;
  double total(double looks, double value, double best) const;

  Look look_;
  const EvidenceSeen* seen_ = nullptr;  ///< null: the first view
  double kept_ = 0, worth_ = 1;         ///< looks: of the views before, of this one
  double floor_ = -std::numeric_limits<double>::infinity();  ///< log epsilon
  double best_before_ = 0, best_now_ = 0;                    ///< totals of the likeliest class
};

/// Stores what was said of a track. Returns what this look adds to the log odds of a phantom.
double rememberEvidence(const Look& look, const MeasurementScan& scan, Track& track);
/// Stores the look that a track is born from, whose log_class has what `m` said, and adds what the
/// look says more.
void rememberBirth(const Measurement& m, const MeasurementScan& scan, const FilterModel& model,
                   Track& track);

}  // namespace perception
