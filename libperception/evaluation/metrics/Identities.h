#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "libperception/core/Frames.h"

namespace perception {

/// One instant for the figures of identities: the true objects, the outputs, and how near they are.
struct IdentityView {
  struct Pair {
    std::size_t truth, estimate;  ///< places in the vectors
    double similarity;            ///< (0, 1]
  };
  std::vector<std::int64_t> truth;
  std::vector<std::uint64_t> estimates;
  std::vector<Pair> pairs;  ///< of all with a similarity above 0
};

/// Similarities 1 - d / `reach` of centers d apart [m], as TrackEval has it for points.
IdentityView identityView(std::vector<std::int64_t> truth, const std::vector<Vector2>& truth_at,
                          std::vector<std::uint64_t> estimates,
                          const std::vector<Vector2>& estimates_at, double reach);

/// Pairs identities one to one so that they have most instants in common. `together`: instants that
/// two identities share, by their numbers (from 0) among `rows` and `columns` of them. Returns the
/// column of each row or -1; identities without a common instant are not paired.
std::vector<int> pairIdentities(
    const std::map<std::pair<std::size_t, std::size_t>, double>& together, std::size_t rows,
    std::size_t columns);

/// HOTA with its parts [luiten2021], means over the similarities .05, .10 ... .95, and IDF1
/// [ristani2016] of all pairs within reach: method.md 11.
struct IdentityFigures {
  std::optional<double> hota, detection, association, idf1;  ///< empty: no truth
};
/// A truth without an identity (negative) is another object at every instant.
IdentityFigures identityFigures(const std::vector<IdentityView>& instants);

}  // namespace perception
