#pragma once
#include <cstdint>
#include <vector>

#include "libperception/filter/state/FilterModel.h"
#include "libperception/filter/state/Track.h"

namespace perception {

/// Pairs of tracks of a scan that describe the same object: the center of one lies inside the
/// footprint of the other, which is impossible for two solid objects ([cornell2007] requires an
/// overlap of half of both footprints; fragments of a vehicle are smaller). A hypothesis that holds
/// both tracks of a pair keeps one. Only footprints of at least `merge_area` of tracks whose class
/// is sure count, or two that are likelier vehicles than not, so that people in a crowd are not
/// merged. The id of the older track is kept. Its
/// state is kept, too, unless it has not been detected recently and the younger track is detected
/// in this scan: then the state is that of the younger track (method.md 5.9), and its id, too, if
/// the older one was detected only once and is likely not there. A person or cyclist who has not
/// been detected recently and a vehicle over them both stay: they are hidden behind it.
/// `merge_area` = 0: no merging. Computed once for all hypotheses.
class DuplicateTable {
 public:
  DuplicateTable() = default;
  /// `tracks` by cell, i.e. index; null entries are ignored.
  DuplicateTable(const FilterModel& model, Stamp now, const TrackTable& tracks);

  /// The cells of a hypothesis after merging, in the same order. A cell number of at least the size
  /// of the table given to the constructor refers to a track of appendReplacements().
  std::vector<std::uint32_t> merged(std::vector<std::uint32_t> cells) const;
  /// Appends the merged tracks that replace older ones; merged() refers to them by their cell.
  void appendReplacements(TrackTable& tracks) const;

 private:
  struct Conflict {
    std::size_t kept, dropped;  // cells
    TrackHandle replacement;    // of the kept one; null: it stays
  };
  std::size_t cells_ = 0;
  std::vector<Conflict> conflicts_;
  std::vector<std::uint32_t> involved_;  // by cell: number among the conflicts' cells, or none
  std::size_t involved_count_ = 0;
};

}  // namespace perception
