#include "libperception/filter/associate/ScanParts.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "libperception/core/math/LogMath.h"
#include "libperception/filter/state/IndexMap.h"

namespace perception {

ScanParts::ScanParts(const AssociationIndex& index) : of_track(index.tracks(), kNoPart) {
  const std::size_t n = index.measurements();
  std::vector<std::size_t> parent(n), first(index.tracks(), n);
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto find = [&](std::size_t m) {
    while (parent[m] != m) m = parent[m] = parent[parent[m]];
    return m;
  };
  for (std::size_t m = 0; m < n; ++m) {
    for (const auto& c : index.candidates(m)) {
      if (first[c.track] == n) {
        first[c.track] = m;
      } else {
        const std::size_t one = find(first[c.track]), other = find(m);
        parent[std::max(one, other)] = std::min(one, other);
      }
    }
  }
  std::vector<std::uint32_t> number(n, kNoPart);
  for (std::size_t m = 0; m < n; ++m) {
    if (index.candidates(m).empty()) continue;
    std::uint32_t& own = number[find(m)];
    if (own == kNoPart) {
      own = static_cast<std::uint32_t>(measurements.size());
      measurements.emplace_back();
    }
    measurements[own].push_back(m);
  }
  for (std::size_t t = 0; t < of_track.size(); ++t)
    if (first[t] < n) of_track[t] = number[find(first[t])];
}

PartVariants::PartVariants(const std::vector<TrackIndices>& tracks, const ScanParts& parts) {
  const std::size_t n = parts.measurements.size();
  of_hypothesis.resize(tracks.size() * n);
  std::vector<std::uint64_t> first(n), signature(n);
  std::vector<char> differs(n, 0);
  std::vector<std::uint64_t> mixed(parts.of_track.size());
  for (std::size_t t = 0; t < mixed.size(); ++t) mixed[t] = mixBits(t + 1);
  IndexMap numbers(4 * n + 64);
  for (std::size_t h = 0; h < tracks.size(); ++h) {
    auto& own = h == 0 ? first : signature;
    std::fill(own.begin(), own.end(), 0);
    for (const std::uint32_t t : tracks[h])
      if (parts.of_track[t] != kNoPart) own[parts.of_track[t]] += mixed[t];
    for (std::uint32_t p = 0; p < n; ++p) {
      std::uint32_t& variant = of_hypothesis[h * n + p];
      if (h > 0 && own[p] == first[p]) {
        variant = of_hypothesis[p];
        continue;
      }
      differs[p] = static_cast<char>(differs[p] | (h > 0));
      const auto [number, fresh] = numbers.numberOf(own[p] + mixBits(~std::uint64_t{p}));
      if (fresh) {
        variants.emplace_back();
        variants.back().part = p;
        variants.back().example = h;
      }
      variant = static_cast<std::uint32_t>(number);
    }
  }
  for (std::uint32_t p = 0; p < n; ++p)
    if (differs[p]) varied.push_back(p);
}

const AssociationIndex::Other& likeliestOther(const AssociationIndex& index, std::size_t m) {
  const auto& others = index.others(m);
  return *std::max_element(others.begin(), others.end(), [](const auto& a, const auto& b) {
    return a.log_weight < b.log_weight;
  });
}

void solveBest(const ScanParts& parts, const std::vector<TrackIndices>& tracks,
               const AssociationIndex& index, PartVariant& v) {
  for (const std::uint32_t t : tracks[v.example])
    if (parts.of_track[t] == v.part) v.columns.push_back(t);
  std::sort(v.columns.begin(), v.columns.end());
  AssignmentProblem problem;
  problem.columns = static_cast<int>(v.columns.size());
  problem.rows.reserve(parts.measurements[v.part].size());
  for (const std::size_t m : parts.measurements[v.part]) {
    auto& row = problem.rows.emplace_back();
    const double other = likeliestOther(index, m).log_weight;
    if (other == kMinusInfinity) continue;
    row.reserve(index.candidates(m).size());
    for (const auto& c : index.candidates(m)) {
      const auto it = std::lower_bound(v.columns.begin(), v.columns.end(), c.track);
      if (it == v.columns.end() || *it != c.track || c.log_odds == kMinusInfinity) continue;
      row.push_back({static_cast<int>(it - v.columns.begin()), c.log_odds - other});
    }
  }
  v.ranking = std::make_unique<AssignmentRanking>(std::move(problem));
  v.addCauses(v.ranking->best().column);
}

}  // namespace perception
