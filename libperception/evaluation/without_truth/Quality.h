#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "libperception/evaluation/matching/TruthSelection.h"
#include "libperception/evaluation/metrics/Metrics.h"
#include "libperception/scene/files/TrackedRun.h"

namespace perception {

/// Errors that only a truth can show.
enum class TrueError { kMissed, kFalse, kPosition, kVelocity, kClass, kSwitches, kOverall };
inline constexpr std::size_t kTrueErrors = 7;
/// Name and unit of each, for reports.
const char* nameOf(TrueError error);

/// Figures of a run that need no truth (method.md 11.3). For all of them, larger is worse.
struct QualityKind {
  const char* name;
  const char* unit;
  const char* meaning;  ///< one sentence
  TrueError follows;    ///< chosen before anything was measured
  /// Spearman's rank correlation with that error, as measured (method.md 11.3): over runs of all
  /// logs, and within a log (mean of logs).
  double between_logs, within_log;
  /// Followed it in one of both; others are not shown to users.
  bool follows_it() const;
};
const std::vector<QualityKind>& qualityKinds();

/// A moment that a person should look at.
struct QualityMoment {
  enum class Kind { kClassChange, kShortLife, kLostInView, kHandover };
  Kind kind = Kind::kClassChange;
  double t = 0;  ///< [s] since the log's first stamp
  std::uint64_t id = 0;
  Vector2 place = Vector2::Zero();  ///< [m] of the object then, world
  std::uint64_t former = 0;         ///< handover: the track that it continues
  std::string text() const;
};
inline constexpr int kMomentKinds = 4;

/// The figures of a run, in the order of qualityKinds(); empty where the run cannot tell.
struct Quality {
  std::vector<Figure> values;
  std::vector<QualityMoment> moments;  ///< in order of time
  std::size_t objects = 0;             ///< tracks of named classes in the sector
  double minutes = 0;                  ///< of all of them together
};

/// What counts: objects of named classes in the sector of `selection` about the vehicle.
struct QualityOptions {
  SelectionOptions selection;  ///< range and fov alone
  std::vector<std::string> unnamed = {"static-other", "static_other", "phantom"};
};

/// `siblings`: runs of the same log that differ by their seed; may be empty. Reads innovations.csv
/// in the run's folder, if it is there. Throws DataError.
Quality qualityOf(const TrackedRun& run, const std::vector<const TrackedRun*>& siblings,
                  const QualityOptions& options);

/// The true errors of a run, in the order of TrueError.
std::array<Figure, kTrueErrors> trueErrors(const Evaluation& evaluation);

/// Spearman's rank correlation of the pairs that have both values, mean ranks for equal values;
/// empty with less than three, or where one side does not vary.
Figure rankCorrelation(const std::vector<Figure>& a, const std::vector<Figure>& b);

}  // namespace perception
