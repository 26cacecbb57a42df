#pragma once
#include <vector>

#include "libperception/filter/Association.h"
#include "libperception/filter/Duplicates.h"
#include "libperception/filter/FilterModel.h"
#include "libperception/filter/LikelihoodTable.h"

namespace perception {

/// The tracks of one scan before it: each distinct one once.
struct ScanTracks {
  std::vector<TrackHandle> before;
  std::vector<Track> predicted;  ///< at the scan's time; untouched ones hold nothing
  std::vector<char> touched;     ///< the scan says something of it: predicted and scored
  std::vector<std::vector<std::size_t>> of_hypothesis;  ///< by distinct hypothesis: indices
};

/// Pass 4: the updated tracks of one scan, made once per distinct (track, cause) that some
/// hypothesis wants and handed out as often as needed.
class Updates {
 public:
  Updates(const ScanTracks& tracks, const LikelihoodTable& table, const MeasurementScan& scan,
          const FilterModel& model);

  /// Calls for the tracks that follow from an association of hypothesis `h`.
  void want(std::size_t h, const Association& association);
  /// Makes all that is wanted; returns how many. `scan_index` goes into the histories.
  std::size_t make(std::uint64_t scan_index);
  /// The hypothesis that follows.
  HypothesisHandle assemble(std::size_t h, const Association& association) const;

 private:
  std::size_t hitCell(std::size_t track, std::size_t k) const;
  std::size_t missCell(std::size_t track) const { return first_[track]; }
  std::size_t newCell(std::size_t k) const { return first_.back() + k; }
  bool keep(const Track& t) const;
  /// `before`: what the track was before the scan; null for a newborn.
  void store(std::size_t cell, Track&& track, const TrackHandle& before);
  /// The cells that follow from an association, in the order of the hypothesis's tracks.
  std::vector<std::size_t> cellsOf(std::size_t h, const Association& association) const;

  const ScanTracks& tracks_;
  const LikelihoodTable& table_;
  const MeasurementScan& scan_;
  const FilterModel& model_;
  std::vector<std::size_t> first_;  ///< cell of each track's miss; its hits follow in pair order
  std::vector<char> wanted_;
  std::vector<TrackHandle> made_;  ///< null when not wanted or dropped
  DuplicateTable duplicates_;
};

}  // namespace perception
