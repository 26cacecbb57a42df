#pragma once
#include <vector>

#include "libperception/filter/associate/Association.h"
#include "libperception/filter/likelihood/LikelihoodTable.h"
#include "libperception/filter/state/FilterModel.h"
#include "libperception/filter/update/Duplicates.h"

namespace perception {

/// The distinct tracks of all hypotheses before and after prediction to a scan.
struct ScanTracks {
  std::vector<TrackHandle> before;
  std::vector<Track> predicted;               ///< to the scan's stamp; empty unless touched
  std::vector<char> touched;                  ///< may be in view: predicted and scored
  std::vector<TrackIndices> of_hypothesis;    ///< by distinct hypothesis
  std::vector<const Hypothesis*> hypotheses;  ///< the distinct ones
};

/// Pass 4: the updated tracks of one scan, computed once per distinct (track, cause) that some
/// child hypothesis needs.
class UpdateCache {
 public:
  UpdateCache(ScanTracks& tracks, const LikelihoodTable& table, const MeasurementScan& scan,
              const FilterModel& model);

  /// Requests the tracks of the next child: hypothesis `h` under an association.
  void request(std::size_t h, const Association& association);
  /// Computes the requested tracks, once after the last request; returns their number. Consumes
  /// ScanTracks::predicted: its tracks are moved from. `scan_index` is hashed into the histories.
  std::size_t compute(std::uint64_t scan_index);
  /// The hypothesis of child `c`, in order of requests. Call once per child.
  HypothesisHandle hypothesis(std::size_t c);

 private:
  using Cell = std::uint32_t;
  Cell hitCell(std::size_t track, std::size_t k) const;
  Cell missCell(std::size_t track) const { return first_[track]; }
  Cell newCell(std::size_t k) const { return first_.back() + static_cast<Cell>(k); }
  bool keep(const Track& t) const;
  /// keep() for a track whose prediction to this scan is deferred: decided by the bounds of
  /// Track::reachable.
  bool keepDeferred(const Track& t) const;
  /// `before`: the track before the scan; null for a newborn.
  void store(Cell cell, Track&& track, const TrackHandle& before);
  /// What child `c` has lost within FilterModel::history seconds.
  std::vector<EndedTrack> endedOf(std::size_t c) const;

  ScanTracks& tracks_;
  const LikelihoodTable& table_;
  const MeasurementScan& scan_;
  const FilterModel& model_;
  std::vector<Cell> first_;  ///< cell of each track's miss; its hits follow in pair order
  std::vector<std::uint32_t> measurement_of_;  ///< by cell of a hit
  std::vector<Cell> of_track_;                 ///< cells in the association that is being looked at
  std::vector<char> requested_;
  std::vector<std::vector<Cell>> children_;  ///< cells, in the order of the hypothesis's tracks
  std::vector<const Hypothesis*> parents_;   ///< by child
  TrackTable computed_;                      ///< null when not wanted or dropped
  DuplicateTable duplicates_;
  std::shared_ptr<const TrackTable> all_;  ///< computed_ and the replacements of duplicates_
  std::vector<std::uint64_t> keys_;        ///< of all_
};

}  // namespace perception
