#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libperception/evaluation/metrics/Evaluation.h"

namespace perception {

/// A metric; empty ("n/a") where it is undefined (no truth, no match), never 0 or NaN instead.
using Figure = std::optional<double>;

/// The metrics of [radecki2016]'s tables of tracking results and related ones, for one class or
/// all, one pairing.
struct TrackingFigures {
  std::size_t active = 0;  ///< counted truth objects over all instants (denominator A)
  std::size_t in_sensor_range = 0,
              returns_in_sensor_range =
                  0;  ///< of these, within the sensor set's range (denominator B)
  std::size_t first_to_last =
      0;  ///< active instants from each object's first to its last tracked one (denominator C)
  std::size_t returns = 0;                 ///< instants tracked: "Number of Returns"
  Figure tracked_a, tracked_b, tracked_c;  ///< returns / denominator A, B, C
  Figure range_rms;              ///< [m] to the closest point of the footprint, as in [radecki2016]
  Figure center_range_rms;       ///< [m] to the center
  Figure bearing_rms;            ///< [rad] of the center
  Figure position_rms;           ///< [m] between the centers
  Figure speed_rms;              ///< [m/s] of the magnitudes
  Figure velocity_rms;           ///< [m/s] of the vectors
  Figure heading_rms;            ///< [rad]
  Figure heading_reversed;       ///< share of headings more than 90 deg off
  Figure heading_sure;           ///< share of headings with p_front of at least kSureFront
  Figure heading_sure_reversed;  ///< share of these more than 90 deg off
  Figure correct, mis, unclassified;  ///< shares of the returns; they sum to 1
  std::size_t id_switches =
      0;  ///< the matched id differs from that of the object's last tracked instant
  std::size_t fragmentations = 0;  ///< gaps: active and not tracked between two tracked instants
};

/// Over all classes (`class_id` < 0) or one.
TrackingFigures trackingFigures(const Evaluation& evaluation, Pairing pairing,
                                ClassId class_id = -1);

/// Tracking results of one truth object.
struct ObjectTimeline {
  std::int64_t id = -1;
  std::string type;
  ClassId class_id = 0;
  double first_active = 0, last_active = 0;  ///< [s]
  std::size_t active = 0, returns = 0;
  Figure first_tracked;            ///< [s]
  Figure time_to_first_track;      ///< [s] from first_active
  Figure tracked;                  ///< share of the active instants
  std::vector<std::uint64_t> ids;  ///< that tracked it, in order of first use
  std::size_t id_switches = 0, fragmentations = 0;
  std::size_t first_to_last = 0;  ///< active instants from the first to the last tracked one
};

/// One for each counted truth object with an id, sorted by first_active, then id.
std::vector<ObjectTimeline> objectTimelines(const Evaluation& evaluation, Pairing pairing);

/// Confusion matrix of truth type and estimated class over all counted truth objects.
struct Confusion {
  struct Row {
    std::vector<std::size_t> classified;  ///< by class: probability >= .95
    std::size_t unclassified = 0, missed = 0;
  };
  std::map<std::string, Row> by_type;
};
Confusion confusion(const Evaluation& evaluation, Pairing pairing);

/// False objects: outputs of a named class in the sector without a truth object of any type within
/// EvaluationOptions::exclusion.
struct FalseObjectFigures {
  std::size_t instants = 0;
  OutputCounts counts;
  Figure per_instant, share;  ///< share: of all outputs of named classes in the sector
  Figure classified_per_instant, classified_share;  ///< the same of outputs with probability >= .95
};
/// Over all classes (`class_id` < 0) or one.
FalseObjectFigures falseObjectFigures(const Evaluation& evaluation, ClassId class_id = -1);

/// GOSPA and OSPA over the instants with a truth object or an estimate.
struct SetFigures {
  std::size_t instants = 0;
  Figure gospa_mean, gospa_rms;          ///< [m] mean; root of the mean square
  Figure localization, missed, false_;   ///< [m^2] mean parts; they sum to gospa_rms^2
  Figure missed_objects, false_objects;  ///< mean number per instant
  Figure localization_rms;               ///< [m] of the pairs
  Figure ospa_mean;                      ///< [m]
};
SetFigures setFigures(const Evaluation& evaluation, double cutoff);

/// Calibration of the class probability: matched outputs, binned by the probability of their most
/// probable class.
struct ReliabilityBin {
  double low = 0, high = 0;
  std::size_t count = 0;
  Figure mean_probability, correct;  ///< mean stated probability; share whose class is the true one
};
struct Reliability {
  std::vector<ReliabilityBin> bins;  ///< equal width over [0, 1]
  Figure calibration_error;  ///< expected calibration error: mean of |stated - correct|, weighted
                             ///< by count
};
Reliability reliability(const Evaluation& evaluation, Pairing pairing);
/// How a truth object moves: below kStandingSpeed [m/s] it stands. Those whose truth has no speed
/// are of no motion but `kAny`.
enum class TruthMotion { kAny, kStanding, kMoving };
inline constexpr double kStandingSpeed = 1;
bool movesSo(const TruthSample& sample, TruthMotion motion);

/// Calibration of p_front: matched outputs with a heading, of all classes or one.
Reliability frontReliability(const Evaluation& evaluation, Pairing pairing, ClassId class_id = -1,
                             TruthMotion motion = TruthMotion::kAny);
/// What is known of the fronts of objects, and how often that is wrong.
struct FrontFigures {
  std::size_t matched = 0, headings = 0, known = 0;  ///< matched; of these with a heading; of
                                                     ///< these with p_front >= kSureFront
  Figure with_heading, front_known;                  ///< shares of the matched
  Figure known_reversed, other_reversed;             ///< shares more than 90 deg off
  Figure calibration_error;                          ///< of p_front
};
FrontFigures frontFigures(const Evaluation& evaluation, Pairing pairing, ClassId class_id = -1,
                          TruthMotion motion = TruthMotion::kAny);
/// Calibration of the existence probability: outputs of a named class in the sector, and the share
/// matched one-to-one to a truth object.
Reliability existenceReliability(const Evaluation& evaluation);

/// CLEAR MOT (Bernardin and Stiefelhagen 2008), one-to-one matching within the tolerance.
struct ClearFigures {
  std::size_t truth = 0;          ///< counted truth objects over all instants
  std::size_t misses = 0;         ///< of these, unmatched
  std::size_t false_objects = 0;  ///< outputs of a named class without a truth object of any type
  std::size_t id_switches = 0;    ///< see TrackingFigures
  Figure mota;                    ///< 1 - (misses + false objects + id switches) / truth

  void setMota();  ///< from the counts
};
/// Equals the definition if EvaluationOptions::exclusion = tolerance: outputs between the two
/// distances are ignored.
ClearFigures clearFigures(const Evaluation& evaluation);
/// HOTA and IDF1 of all classes.
IdentityFigures identityFigures(const Evaluation& evaluation);

/// RMS difference in the number of objects between two runs (in [radecki2016] against a run of 50
/// particles) at common instants; empty when there are none.
struct CountDifference {
  std::size_t instants = 0;
  Figure all, classified;
};
CountDifference countDifference(const TrackedRun& run, const TrackedRun& reference);

}  // namespace perception
