#pragma once
#include <cstdint>
#include <vector>

#include "libperception/filter/state/FilterModel.h"
#include "libperception/filter/state/Track.h"

namespace perception {

/// Which of a scan's distinct tracks cannot both be in one hypothesis, because one stands inside
/// the other's footprint: two solid objects cannot ([cornell2007] asks for an overlap of half of
/// both; a fragment of a vehicle is smaller than that). Only footprints larger than `merge_area`
/// swallow others, so people in a crowd stay apart. The older track keeps its identity; when it has
/// not been seen lately and the younger one has, it takes over the younger one's state.
/// `merge_area` = 0: nothing is merged. Found once for all hypotheses.
class DuplicateTable {
 public:
  DuplicateTable() = default;
  /// `tracks` by cell; null ones are not there.
  DuplicateTable(const FilterModel& model, Stamp now, const TrackTable& tracks);

  /// The cells of one hypothesis without its duplicates, in the same order. Cells beyond those of
  /// the table that it was made from are those of the replacements.
  std::vector<std::uint32_t> merged(std::vector<std::uint32_t> cells) const;
  /// Tracks of these cells.
  void appendReplacements(TrackTable& tracks) const;

 private:
  struct Conflict {
    std::size_t older, younger;  // cells
    TrackHandle replacement;     // of the older one; null: it stays
  };
  std::size_t cells_ = 0;
  std::vector<Conflict> conflicts_;
  std::vector<std::uint32_t> involved_;  // by cell: number among the conflicts' cells, or none
  std::size_t involved_count_ = 0;
};

}  // namespace perception
