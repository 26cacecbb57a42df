#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libperception/evaluation/matching/Footprint.h"
#include "libperception/evaluation/matching/Matching.h"
#include "libperception/evaluation/matching/TruthAlignment.h"
#include "libperception/evaluation/matching/TruthSelection.h"
#include "libperception/evaluation/metrics/Identities.h"
#include "libperception/evaluation/metrics/SetDistance.h"

namespace perception {

/// Parameters of an evaluation; defaults: method.md 11 and [radecki2016].
struct EvaluationOptions {
  SelectionOptions selection;
  AlignmentOptions alignment;
  double tolerance = 2;  ///< [m] largest distance between the centers of truth and matched estimate
  double exclusion =
      3;  ///< [m] an output within this distance of any truth object is not a false object
  double cutoff = 2;  ///< [m] c of GOSPA and OSPA
  /// Classes whose outputs are ignored, since the truth does not label poles and walls.
  std::vector<std::string> unnamed = {"static-other", "static_other", "phantom"};
  double min_existence = 0;  ///< outputs below are excluded from all metrics except the calibration
  /// Letters of the sensor set (C, L, R) for denominator B; empty: the modalities of any output's
  /// last_hit_*.
  std::string sensors;
};

/// The estimate matched to a truth object and its errors (estimate minus truth).
struct Match {
  std::uint64_t id = 0;
  ClassId class_id = 0;
  bool classified = false;
  double probability = 0;  ///< of class_id
  double distance = 0;     ///< [m] between the centers
  GroundView view;
  std::optional<double>
      speed_error;  ///< [m/s] difference of the magnitudes; if the truth has a velocity
  std::optional<double> velocity_error;  ///< [m/s] magnitude of the difference of the vectors
  std::optional<double> heading_error;   ///< [rad] in (-pi, pi]; if both have a heading
  double front_probability = 0.5;        ///< stated probability that its heading is not reversed
};

/// One counted truth object at one instant: the sample of all metrics.
struct TruthSample {
  std::size_t instant = 0;  ///< place in Evaluation::instants
  double t = 0;             ///< [s] since the log's first stamp
  std::int64_t id = -1;
  std::string type;      ///< as in the truth
  ClassId class_id = 0;  ///< in Evaluation::class_names
  GroundView view;
  std::optional<double> speed;                        ///< [m/s] of the truth; empty: it has none
  bool in_sensor_range = true;                        ///< denominator B of method.md 11
  std::array<std::optional<Match>, kPairings> match;  ///< by Pairing

  const std::optional<Match>& matched(Pairing p) const {
    return match[static_cast<std::size_t>(p)];
  }
};

/// Number of outputs of a named class in the sector, and of false ones among them.
struct OutputCounts {
  std::size_t named = 0, false_ = 0;                       ///< by the most probable class
  std::size_t classified_named = 0, classified_false = 0;  ///< of these, probability >= .95

  OutputCounts& operator+=(const OutputCounts& other);
};

/// A false object: an output of a named class in the sector without a truth object within
/// EvaluationOptions::exclusion.
struct FalseObject {
  std::uint64_t id = 0;
  ClassId class_id = 0;
  bool classified = false;
};

/// An output of a named class in the sector, for the calibration of the existence probability.
struct ExistenceSample {
  std::size_t instant = 0;
  double probability = 0;  ///< as stated
  bool real = false;       ///< matched to a truth object of any type
};

/// One evaluated instant.
struct InstantFigures {
  std::int64_t frame = -1;
  double t = 0;                       ///< [s] since the log's first stamp
  std::size_t truth = 0;              ///< counted truth objects
  std::size_t estimates = 0;          ///< number of estimates in the GOSPA and OSPA sets
  std::vector<OutputCounts> outputs;  ///< by class
  std::vector<FalseObject> false_objects;
  /// Outputs of a named class without a truth object of any type: false objects of MOTA.
  std::size_t not_real = 0;
  Gospa gospa;
  double ospa = 0;          ///< [m]
  IdentityView identities;  ///< of the same sets

  OutputCounts allOutputs() const;
};

/// Comparison of a run with the truth, before averaging.
struct Evaluation {
  std::vector<std::string> class_names;
  std::vector<bool> named;  ///< by class
  std::string sensors;      ///< modality letters that denominator B is for; empty: unknown
  std::vector<InstantFigures> instants;
  std::vector<TruthSample> samples;  ///< in order of time
  std::vector<ExistenceSample> existence;
  TruthAlignment alignment;  ///< counters only; `instants` is empty
  std::array<std::size_t, kTruthUses>
      truth_use{};  ///< truth lines at evaluated instants, by TruthUse
};

/// Compares every scene that has a truth, from the first one on. Estimates are the lines of
/// tracks.csv, i.e. objects with existence >= [scene] min_existence.
Evaluation evaluate(const TrackedRun& run, const GroundTruth& truth,
                    const EvaluationOptions& options);

/// Concatenates the instants of several runs, so that metrics are pooled over trials as in
/// [radecki2016]. Truth ids of different runs are kept distinct. Throws DataError when the runs'
/// classes differ.
Evaluation pooled(const std::vector<const Evaluation*>& parts);

}  // namespace perception
