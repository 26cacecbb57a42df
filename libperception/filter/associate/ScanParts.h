#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "libperception/filter/associate/Association.h"
#include "libperception/filter/associate/RankedAssignments.h"

namespace perception {

constexpr std::uint32_t kNoPart = static_cast<std::uint32_t>(-1);

/// Connected components of the measurements of a scan that share candidate tracks in any
/// hypothesis.
struct ScanParts {
  std::vector<std::vector<std::size_t>> measurements;  ///< by part, ascending
  std::vector<std::uint32_t> of_track;                 ///< kNoPart: nothing lies in its gate

  explicit ScanParts(const AssociationIndex& index);
};

using Causes = std::vector<int>;  ///< by measurement of a part: index of a distinct track, or kNew

/// The assignment problem of one part for all hypotheses that hold the same tracks in it.
struct PartVariant {
  std::uint32_t part = 0;
  std::size_t example = 0;                     ///< a hypothesis that sees it so
  std::unique_ptr<AssignmentRanking> ranking;  ///< with its best assignment
  std::vector<std::size_t> columns;            ///< distinct track by column of the ranking
  std::vector<double> losses;                  ///< of all but the best

  std::vector<Causes> causes;  ///< by rank

  void addCauses(const std::vector<int>& column) {
    Causes& out = causes.emplace_back(column.size(), Association::kNew);
    for (std::size_t i = 0; i < column.size(); ++i) {
      if (column[i] != RankedAssignment::kNothing)
        out[i] = static_cast<int>(columns[static_cast<std::size_t>(column[i])]);
    }
  }
};

/// The variants of all parts for all hypotheses.
struct PartVariants {
  std::vector<PartVariant> variants;
  std::vector<std::uint32_t> of_hypothesis;  ///< by hypothesis and part: index of the variant
  std::vector<std::uint32_t> varied;         ///< parts that not all hypotheses see alike

  PartVariants(const std::vector<TrackIndices>& tracks, const ScanParts& parts);
};

/// The most likely cause other than a track. There is only one unless births are sampled.
const AssociationIndex::Other& likeliestOther(const AssociationIndex& index,
                                              std::size_t measurement);

/// Computes the best assignment of a variant.
void solveBest(const ScanParts& parts, const std::vector<TrackIndices>& tracks,
               const AssociationIndex& index, PartVariant& variant);

}  // namespace perception
