#pragma once
#include <cstddef>
#include <vector>

#include "libperception/filter/likelihood/LikelihoodTable.h"
#include "libperception/filter/likelihood/PairDensity.h"
#include "libperception/filter/likelihood/RepeatedEvidence.h"
#include "libperception/measurement/models/PositionOnlyModel.h"

namespace perception {

/// Terms of a scan's likelihoods that do not depend on the track, computed once per scan.
class ScanTerms {
 public:
  ScanTerms(const MeasurementScan& scan, const FilterModel& model);

  /// logLabelOf(), logLabelAndScore() of measurement k and class j.
  double label(std::size_t k, std::size_t j) const { return labels_[k * classes_ + j].label; }
  double labelAndScore(std::size_t k, std::size_t j) const {
    return labels_[k * classes_ + j].label_and_score;
  }
  /// The class that never moves, or -1: what stands moves like it.
  ClassId still() const { return still_; }
  /// The model if it is position-only, so that positionRow() applies; else null.
  const PositionOnlyModel* place() const { return place_; }

  const MeasurementScan& scan;
  const FilterModel& model;
  const Gates& gates;
  /// Exponent of the track's innovations as evidence of its class.
  double kinematicExponent(const Track& track) const {
    return track.evidence.empty() ? alone_kinematic_exponent_ : kinematic_exponent_;
  }

  const double label_exponent, detection_exponent;
  std::vector<double> log_prior;  ///< by class

 private:
  struct Labels {
    double label, label_and_score;
  };
  const double kinematic_exponent_, alone_kinematic_exponent_;
  std::size_t classes_;
  std::vector<Labels> labels_;
  const PositionOnlyModel* place_ = nullptr;
  ClassId still_ = -1;
};

/// Accumulates the likelihoods of one track-measurement pair over the classes.
class PairTerms {
 public:
  PairTerms(const Track& track, const ClassValues& detection, std::size_t measurement,
            const ScanTerms& terms, PairLikelihood& pair);
  /// `log_detection`: log P_D of the class.
  void add(std::size_t j, const Density& density, double log_detection);
  /// Sets the mixture likelihood of all classes added; -inf if none was.
  void finish();
  const ClassValues& mixture() const { return mixture_; }

 private:
  /// Innovations of what is told by its shape, as evidence of the class: vehicles may stand, and
  /// what is seen of a long thing may go along with the sensor.
  void weighMotions();
  /// Log likelihood that what filter j tracks goes along with the sensor's vehicle; at most 0.
  double logGoesAlong(std::size_t j) const;

  const Track& track_;
  const ScanTerms& terms_;
  const Measurement& m_;
  PairLikelihood& pair_;
  const double kinematic_exponent_;
  std::optional<RepeatedEvidence> evidence_;
  ClassValues mixture_;
  ClassValues log_density_;  // by class; -inf: none
};

/// Upper bound of P_D: with P_D = 1 a single missed detection would set the existence probability
/// to 0.
inline constexpr double kMaxDetection = 0.999;
/// Unoccluded share of the track's directions (method.md 5.8), at least [filter]
/// occluded_detection.
double visibilityOf(const Track& track, const MeasurementScan& scan, const FilterModel& model);

/// Row of the likelihood table for a position-only sensor and a track without motion modes: same
/// values as the general code at a fraction of its cost. `row.predictions` stays empty.
void positionRow(const Track& track, const std::vector<std::size_t>& near, const ScanTerms& terms,
                 TrackLikelihoods& row);
/// Whether positionRow() applies to the track.
bool takesPositionRow(const Track& track, const ScanTerms& terms);

}  // namespace perception
