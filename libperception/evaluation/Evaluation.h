#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libperception/evaluation/Footprint.h"
#include "libperception/evaluation/Matching.h"
#include "libperception/evaluation/SetDistance.h"
#include "libperception/evaluation/TruthAlignment.h"
#include "libperception/evaluation/TruthSelection.h"

namespace perception {

/// How a run is judged; defaults: method.md 11 and [radecki2016].
struct EvaluationOptions {
  SelectionOptions selection;
  AlignmentOptions alignment;
  double tolerance = 2;  ///< [m] between the centers of a truth and its estimate
  double exclusion = 3;  ///< [m] an output this near to any truth is not a false object
  double cutoff = 2;     ///< [m] c of GOSPA and OSPA
  /// Classes that are neither right nor wrong to output: the truth does not label poles and walls.
  std::vector<std::string> unnamed = {"static-other", "static_other", "phantom"};
  double min_existence = 0;  ///< outputs below are left out of all figures but the calibration
  /// Letters of the sensor set (C, L, R) for denominator B; empty: the modalities that ever hit an
  /// output object.
  std::string sensors;
};

/// The estimate that was given to a truth object, and its errors (estimate minus truth).
struct Match {
  std::uint64_t id = 0;
  ClassId class_id = 0;
  bool classified = false;
  double probability = 0;  ///< of class_id
  double distance = 0;     ///< [m] between the centers
  GroundView view;
  std::optional<double> speed_error;  ///< [m/s] of the magnitudes; where the truth has a velocity
  std::optional<double> velocity_error;  ///< [m/s] magnitude of the difference of the vectors
  std::optional<double> heading_error;   ///< [rad] in (-pi, pi]; where both have a heading
};

/// One counted truth object at one instant: what all figures are made of.
struct TruthSample {
  std::size_t instant = 0;  ///< place in Evaluation::instants
  double t = 0;             ///< [s] since the log's first stamp
  std::int64_t id = -1;
  std::string type;      ///< as in the truth
  ClassId class_id = 0;  ///< in Evaluation::class_names
  GroundView view;
  bool in_sensor_range = true;                        ///< denominator B of method.md 11
  std::array<std::optional<Match>, kPairings> match;  ///< by Pairing

  const std::optional<Match>& matched(Pairing p) const {
    return match[static_cast<std::size_t>(p)];
  }
};

/// Outputs as a named class inside the sector, and those of them that have no truth anywhere near.
struct OutputCounts {
  std::size_t named = 0, false_ = 0;                       ///< by the most probable class
  std::size_t classified_named = 0, classified_false = 0;  ///< of these, probability >= .95

  OutputCounts& operator+=(const OutputCounts& other);
};

/// An output as a named class inside the sector that has no truth anywhere near.
struct FalseObject {
  std::uint64_t id = 0;
  ClassId class_id = 0;
  bool classified = false;
};

/// An output as a named class inside the sector, for the calibration of the existence probability.
struct ExistenceSample {
  std::size_t instant = 0;
  double probability = 0;  ///< as stated
  bool real = false;       ///< it is the output of some truth object, of whatever type
};

/// One evaluated instant.
struct InstantFigures {
  std::int64_t frame = -1;
  double t = 0;                       ///< [s] since the log's first stamp
  std::size_t truth = 0;              ///< counted truth objects
  std::size_t estimates = 0;          ///< estimates in the set distances
  std::vector<OutputCounts> outputs;  ///< by class
  std::vector<FalseObject> false_objects;
  Gospa gospa;
  double ospa = 0;  ///< [m]

  OutputCounts allOutputs() const;
};

/// A run held against the truth, before any averaging.
struct Evaluation {
  std::vector<std::string> class_names;
  std::vector<bool> named;  ///< by class
  std::string sensors;      ///< letters that denominator B was built for; empty: unknown
  std::vector<InstantFigures> instants;
  std::vector<TruthSample> samples;  ///< in order of time
  std::vector<ExistenceSample> existence;
  TruthAlignment alignment;  ///< counts only; its instants are moved out
  std::array<std::size_t, kTruthUses>
      truth_use{};  ///< truth lines at evaluated instants, by TruthUse
};

/// Compares every scene of the run that has a truth. All such instants count, the first ones too; a
/// truth object without estimates around is missed. Estimates are the run's lines as they are (it
/// writes objects of existence > .5).
Evaluation evaluate(const TrackedRun& run, const GroundTruth& truth,
                    const EvaluationOptions& options);

/// All instants of several runs as those of one: figures over it are pooled over trials, as the
/// paper's are. Truth objects of different runs stay different. Throws DataError when the runs'
/// classes differ.
Evaluation pooled(const std::vector<const Evaluation*>& parts);

}  // namespace perception
