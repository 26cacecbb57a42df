#pragma once
#include <cstdint>
#include <vector>

#include "libperception/filter/state/FilterModel.h"
#include "libperception/filter/state/Track.h"

namespace perception {

/// Pairs of a scan's distinct tracks that are merged wherever a hypothesis holds both: the center
/// of one lies inside the footprint of the other, which solid objects exclude ([cornell2007]
/// requires an overlap of half of both footprints; fragments of a vehicle are smaller). Only
/// footprints larger than `merge_area` count, so that people in a crowd are not merged. The older
/// track keeps its id, and takes the state of the younger one if only that one was detected
/// recently. `merge_area` = 0: no merging. Computed once for all hypotheses.
class DuplicateTable {
 public:
  DuplicateTable() = default;
  /// `tracks` by cell, i.e. index; null entries are ignored.
  DuplicateTable(const FilterModel& model, Stamp now, const TrackTable& tracks);

  /// The cells of one hypothesis without duplicates, in the same order. Cells beyond the table
  /// given to the constructor refer to the replacements.
  std::vector<std::uint32_t> merged(std::vector<std::uint32_t> cells) const;
  /// Appends the tracks of these cells.
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
