#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libperception/core/CsvStream.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/core/TruthRows.h"

namespace perception {

/// Scenes whose truth is asked for.
struct TruthSpan {
  double from = 0, to = 0;                         ///< [s] since the log's first stamp
  std::int64_t first_frame = -1, last_frame = -1;  ///< -1: unknown
};

/// FILE.truth.csv read in step with a run: gives the instants around the scenes of now. A file that
/// is not in order of time is read as a whole first.
class TruthStream {
 public:
  /// Throws DataError as readGroundTruth(); faults of later lines are thrown by around().
  explicit TruthStream(const std::string& path);

  /// All instants that can belong to the scenes: up to a second apart, or with a frame number among
  /// theirs. Spans in ascending order. Valid until the next call.
  const GroundTruth& around(const TruthSpan& span);

 private:
  void nextInstant();
  void nextSorted();

  std::unique_ptr<CsvStream> rows_;  // null: sorted_ has all
  std::vector<GroundTruth::Instant> sorted_;
  std::size_t given_ = 0;  // of sorted_
  TruthOrder order_;
  GroundTruth window_;
  std::optional<TruthObject> pending_;  // first row of the instant after next_
  std::optional<GroundTruth::Instant> next_;
};

}  // namespace perception
