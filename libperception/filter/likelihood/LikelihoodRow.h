#pragma once
#include <cstddef>
#include <vector>

#include "libperception/filter/likelihood/LikelihoodTable.h"
#include "libperception/filter/likelihood/PairDensity.h"
#include "libperception/measurement/PositionOnlyModel.h"

namespace perception {

/// What a scan says whatever the track: made once for all rows of the table.
class ScanTerms {
 public:
  ScanTerms(const MeasurementScan& scan, const FilterModel& model);

  /// logLabelOf(), logLabelAndScore() of measurement k and class j.
  double label(std::size_t k, std::size_t j) const { return labels_[k * classes_ + j].label; }
  double labelAndScore(std::size_t k, std::size_t j) const {
    return labels_[k * classes_ + j].label_and_score;
  }
  /// Not null: rows may be made by positionRow().
  const PositionOnlyModel* place() const { return place_; }

  const MeasurementScan& scan;
  const FilterModel& model;
  const Gates& gates;
  const double label_exponent, detection_exponent;
  std::vector<double> log_prior;  ///< by class

 private:
  struct Labels {
    double label, label_and_score;
  };
  std::size_t classes_;
  std::vector<Labels> labels_;
  const PositionOnlyModel* place_ = nullptr;
};

/// What the classes say of one pair, class by class; then their sum.
class PairTerms {
 public:
  PairTerms(const Track& track, std::size_t measurement, const ScanTerms& terms,
            PairLikelihood& pair);
  /// `log_detection`: log P_D of the class.
  void add(std::size_t j, const Density& density, double log_detection);
  /// Of all classes added; the likelihood is -inf where there is none.
  void finish();
  const ClassValues& mixture() const { return mixture_; }

 private:
  const Track& track_;
  const ScanTerms& terms_;
  const Measurement& m_;
  PairLikelihood& pair_;
  ClassValues mixture_;
};

/// P_D = 1 would make one miss a proof.
inline constexpr double kMaxDetection = 0.999;
/// Share of the track's directions that nothing nearer hides; at least what hidden ones keep.
double visibilityOf(const Track& track, const MeasurementScan& scan, const FilterModel& model);

/// A row of a sensor that sees the place alone, for tracks without motion modes: the numbers of the
/// general way at a fraction of its cost. `row.predictions` stay empty.
void positionRow(const Track& track, const std::vector<std::size_t>& near, const ScanTerms& terms,
                 TrackLikelihoods& row);
/// Whether positionRow() may make it.
bool takesPositionRow(const Track& track, const ScanTerms& terms);

}  // namespace perception
