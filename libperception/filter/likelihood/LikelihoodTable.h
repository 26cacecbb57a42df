#pragma once
#include <vector>

#include "libperception/filter/likelihood/Gating.h"
#include "libperception/filter/likelihood/Innovation.h"
#include "libperception/filter/state/ClassValues.h"
#include "libperception/filter/state/FilterModel.h"
#include "libperception/filter/state/Track.h"
#include "libperception/measurement/models/MeasurementModel.h"

namespace perception {

/// One gated track-measurement pair: its likelihood and intermediate results for the update.
struct PairLikelihood {
  std::size_t measurement = 0;
  double log_likelihood = 0;  ///< lhat: log sum_j p(class j) p(z, label, score, detected | class j)
  double log_prior =
      0;  ///< log of the assignment prior (method.md 5.15), not part of the likelihood
  ClassValues log_by_class;        ///< l_j: log p(z, label, score, detected | class j)
  ClassValues log_class_evidence;  ///< l_j with tempered label and innovations (method.md 5.6): for
                                   ///< the class update only
  double stands = 0, goes_along = 0;  ///< Track::stands, Track::goes_along after it
  ClassValues nis;                    ///< normalized innovation squared of each class filter
  double phantom = 0;                 ///< BirthLikelihood::phantom of the measurement
};

/// Likelihoods of one predicted track for all gated measurements of a scan.
struct TrackLikelihoods {
  double detection = 0;  ///< P_D = sum_j p(class j) P_D(class j)
  double seen = 0;       ///< P(detected), as an object or as a phantom
  ClassValues detection_by_class;
  double visible = 1;                       ///< share of the object's directions that are open
  bool in_view = false;                     ///< P_D of some class is positive, occlusion aside
  std::vector<AxisPrediction> predictions;  ///< by class; empty for position-only models
  std::vector<PairLikelihood> pairs;        ///< in order of measurement
};

/// A measurement as birth (first measurement of a new object) or as clutter.
struct BirthLikelihood {
  double log_birth = 0, log_clutter = 0;  ///< log densities per scan and unit of the axes seen
  double log_new = 0;                     ///< log(birth + phantom + clutter)
  double existence = 0;                   ///< (birth + phantom) / new
  double phantom = 0;                     ///< phantom / (birth + phantom)
  std::vector<double> log_class;          ///< class posterior of the newborn
};

/// Pass 2: every distinct track against every gated measurement, once (method.md 5.2, 5.3).
struct LikelihoodTable {
  std::vector<TrackLikelihoods> tracks;
  std::vector<BirthLikelihood> births;
};

/// Rows of tracks that are not `touched` (out of view) stay empty.
LikelihoodTable likelihoodTable(const std::vector<Track>& predicted,
                                const std::vector<char>& touched, const MeasurementScan& scan,
                                const FilterModel& model);

/// All tracks touched.
LikelihoodTable likelihoodTable(const std::vector<Track>& predicted, const MeasurementScan& scan,
                                const FilterModel& model);

}  // namespace perception
