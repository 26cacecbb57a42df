#pragma once
#include <vector>

#include "libperception/filter/associate/Association.h"
#include "libperception/filter/likelihood/LikelihoodTable.h"
#include "libperception/filter/state/FilterModel.h"
#include "libperception/filter/update/Duplicates.h"

namespace perception {

/// The tracks of one scan before it: each distinct one once.
struct ScanTracks {
  std::vector<TrackHandle> before;
  std::vector<Track> predicted;             ///< at the scan's time; untouched ones hold nothing
  std::vector<char> touched;                ///< the scan says something of it: predicted and scored
  std::vector<TrackIndices> of_hypothesis;  ///< by distinct hypothesis
};

/// Pass 4: the updated tracks of one scan, made once per distinct (track, cause) that some
/// hypothesis wants and handed out as often as needed.
class UpdateCache {
 public:
  UpdateCache(ScanTracks& tracks, const LikelihoodTable& table, const MeasurementScan& scan,
              const FilterModel& model);

  /// Calls for the tracks that follow from an association of hypothesis `h`: the next child.
  void request(std::size_t h, const Association& association);
  /// Makes all that is wanted, of the predicted tracks, which are used up; returns how many.
  /// `scan_index` goes into the histories.
  std::size_t compute(std::uint64_t scan_index);
  /// The hypothesis of child `c`, counted as they were called for; once.
  HypothesisHandle hypothesis(std::size_t c);

 private:
  using Cell = std::uint32_t;
  Cell hitCell(std::size_t track, std::size_t k) const;
  Cell missCell(std::size_t track) const { return first_[track]; }
  Cell newCell(std::size_t k) const { return first_.back() + static_cast<Cell>(k); }
  bool keep(const Track& t) const;
  /// The same of a track that the scan left behind, by its reachable.
  bool keepDeferred(const Track& t) const;
  /// `before`: what the track was before the scan; null for a newborn.
  void store(Cell cell, Track&& track, const TrackHandle& before);

  ScanTracks& tracks_;
  const LikelihoodTable& table_;
  const MeasurementScan& scan_;
  const FilterModel& model_;
  std::vector<Cell> first_;  ///< cell of each track's miss; its hits follow in pair order
  std::vector<std::uint32_t> measurement_of_;  ///< by cell of a hit
  std::vector<Cell> of_track_;                 ///< cells in the association that is being looked at
  std::vector<char> requested_;
  std::vector<std::vector<Cell>> children_;  ///< cells, in the order of the hypothesis's tracks
  TrackTable computed_;                      ///< null when not wanted or dropped
  DuplicateTable duplicates_;
  std::shared_ptr<const TrackTable> all_;  ///< computed_ and what the duplicates became
  std::vector<std::uint64_t> keys_;        ///< of all_
};

}  // namespace perception
