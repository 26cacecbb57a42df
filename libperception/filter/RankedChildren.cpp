#include "libperception/filter/RankedChildren.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <memory>
#include <numeric>
#include <queue>
#include <utility>

#include "libperception/core/LogMath.h"
#include "libperception/filter/Numbering.h"
#include "libperception/filter/Parallel.h"
#include "libperception/filter/RankedAssignments.h"
#include "libperception/filter/RankedSums.h"

namespace perception {
namespace {

constexpr std::uint32_t kNoPart = static_cast<std::uint32_t>(-1);
using Causes = std::vector<int>;  // by measurement of a part: index of a distinct track, or kNew

/// Measurements that share candidates, directly or through others, whatever the hypothesis.
struct Parts {
  std::vector<std::vector<std::size_t>> measurements;  // by part, ascending
  std::vector<std::uint32_t> of_track;                 // kNoPart: nothing lies in its gate

  explicit Parts(const AssociationIndex& index) : of_track(index.tracks(), kNoPart) {
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
};

/// One part as the hypotheses see it that hold the same tracks in it.
struct Variant {
  std::uint32_t part = 0;
  std::size_t example = 0;                     // a hypothesis that sees it so
  std::unique_ptr<AssignmentRanking> ranking;  // with its best assignment
  std::vector<std::size_t> columns;            // distinct track by column of the ranking
  std::vector<RankedAssignment> ranked;        // best first
  std::vector<double> losses;                  // of all but the best

  Causes causes(std::size_t rank) const {
    const auto& column = rank == 0 ? ranking->best().column : ranked[rank].column;
    Causes out(column.size(), Association::kNew);
    for (std::size_t i = 0; i < column.size(); ++i) {
      if (column[i] != RankedAssignment::kNothing)
        out[i] = static_cast<int>(columns[static_cast<std::size_t>(column[i])]);
    }
    return out;
  }
};

/// All parts as all hypotheses see them.
struct Variants {
  std::vector<Variant> variants;
  std::vector<std::uint32_t> of_hypothesis;  // by hypothesis and part: index of the variant
  std::vector<std::uint32_t> varied;         // parts that not all hypotheses see alike

  Variants(const std::vector<std::vector<std::size_t>>& tracks, const Parts& parts) {
    const std::size_t n = parts.measurements.size();
    of_hypothesis.resize(tracks.size() * n);
    std::vector<std::uint64_t> first(n), signature(n);
    std::vector<char> differs(n, 0);
    std::vector<std::uint64_t> mixed(parts.of_track.size());
    for (std::size_t t = 0; t < mixed.size(); ++t) mixed[t] = mixBits(t + 1);
    Numbering numbers(4 * n + 64);
    for (std::size_t h = 0; h < tracks.size(); ++h) {
      auto& own = h == 0 ? first : signature;
      std::fill(own.begin(), own.end(), 0);
      for (const std::size_t t : tracks[h])
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
};

/// Of the causes that are no track the likeliest stands for all: there is only one unless births
/// are sampled.
const AssociationIndex::Other& likeliestOther(const AssociationIndex& index, std::size_t m) {
  const auto& others = index.others(m);
  return *std::max_element(others.begin(), others.end(), [](const auto& a, const auto& b) {
    return a.log_weight < b.log_weight;
  });
}

void solveBest(const Parts& parts, const std::vector<std::vector<std::size_t>>& tracks,
               const AssociationIndex& index, Variant& v) {
  for (const std::size_t t : tracks[v.example])
    if (parts.of_track[t] == v.part) v.columns.push_back(t);
  std::sort(v.columns.begin(), v.columns.end());
  AssignmentProblem problem;
  problem.columns = static_cast<int>(v.columns.size());
  for (const std::size_t m : parts.measurements[v.part]) {
    auto& row = problem.rows.emplace_back();
    const double other = likeliestOther(index, m).log_weight;
    if (other == kMinusInfinity) continue;
    for (const auto& c : index.candidates(m)) {
      const auto it = std::lower_bound(v.columns.begin(), v.columns.end(), c.track);
      if (it == v.columns.end() || *it != c.track || c.log_odds == kMinusInfinity) continue;
      row.push_back({static_cast<int>(it - v.columns.begin()), c.log_odds - other});
    }
  }
  v.ranking = std::make_unique<AssignmentRanking>(std::move(problem));
}

/// A child before its causes are written down.
struct Draft {
  std::size_t parent;
  std::size_t rank;  // among the children of the parent
  double log_weight;
  RankedSums::Sum sum;
};

/// The best `slots` weights seen so far: what is below them cannot survive.
class Survivors {
 public:
  Survivors(std::size_t slots, double floor) : slots_(slots), floor_(floor) {}
  void add(double weight) {
    if (weight < floor_) return;
    weights_.push(weight);
    if (weights_.size() > slots_) weights_.pop();
    if (weights_.size() == slots_) floor_ = std::max(floor_, weights_.top());
  }
  double floor() const { return floor_; }

 private:
  std::size_t slots_;
  double floor_;
  std::priority_queue<double, std::vector<double>, std::greater<>> weights_;
};

}  // namespace

std::vector<RankedChild> rankChildren(const std::vector<std::vector<std::size_t>>& tracks,
                                      const std::vector<double>& log_weights,
                                      const AssociationIndex& index, const RankingLimits& limits) {
  const Parts parts(index);
  const std::size_t n = parts.measurements.size(), hypotheses = tracks.size();
  Variants all(tracks, parts);
  auto& variants = all.variants;
  parallelFor(variants.size(),
              [&](std::size_t i) { solveBest(parts, tracks, index, variants[i]); });

  Association base;  // of all hypotheses alike: nothing is of a track yet
  for (std::size_t m = 0; m < index.measurements(); ++m) {
    const auto& other = likeliestOther(index, m);
    base.cause.push_back(other.cause);
    if (other.log_weight > kMinusInfinity) base.log_weight += other.log_weight;
  }
  std::vector<double> best_of(variants.size());
  for (std::size_t v = 0; v < variants.size(); ++v)
    best_of[v] = variants[v].ranking->best().log_weight;
  std::vector<double> best(hypotheses);
  for (std::size_t h = 0; h < hypotheses; ++h) {
    best[h] = 0;
    for (const std::size_t t : tracks[h]) best[h] += index.logMiss(t);
    best[h] += base.log_weight;
    for (std::size_t p = 0; p < n; ++p) best[h] += best_of[all.of_hypothesis[h * n + p]];
    best[h] += log_weights[h];
  }

  // Children of the likeliest hypotheses first: the floor rises early.
  std::vector<std::size_t> order(hypotheses);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return best[a] > best[b]; });
  Survivors survivors(limits.slots, best[order.front()] - limits.span);
  for (const double weight : best) survivors.add(weight);
  std::vector<double> reach_of(variants.size(), kMinusInfinity);  // loss that some can afford
  for (const std::size_t h : order) {
    const double loss = best[h] - survivors.floor();
    if (loss < 0) break;
    for (std::size_t p = 0; p < n; ++p) {
      double& reach = reach_of[all.of_hypothesis[h * n + p]];
      reach = std::max(reach, loss);
    }
  }
  parallelFor(variants.size(), [&](std::size_t i) {
    Variant& v = variants[i];
    if (reach_of[i] < 0) return;
    v.ranked = v.ranking->rank(limits.children, reach_of[i]);
    for (std::size_t k = 1; k < v.ranked.size(); ++k)
      v.losses.push_back(v.ranked[0].log_weight - v.ranked[k].log_weight);
  });

  std::vector<double> first_loss(variants.size(), std::numeric_limits<double>::infinity());
  for (std::size_t v = 0; v < variants.size(); ++v)
    if (!variants[v].losses.empty()) first_loss[v] = variants[v].losses.front();

  // What all hypotheses see alike is joined once.
  const auto join = [&](std::uint32_t variant, double limit, RankedSums& sums) {
    const auto& losses = variants[variant].losses;
    sums.join(variant, losses.data(), losses.size(), limit);
  };
  RankedSums sums(limits.children);
  for (std::uint32_t p = 0, next = 0; p < n; ++p) {
    const bool varied = next < all.varied.size() && all.varied[next] == p;
    if (varied) {
      ++next;
    } else {
      join(all.of_hypothesis[p], best[order.front()] - survivors.floor(), sums);
    }
  }
  const std::vector<RankedSums::Sum> alike = sums.sums();
  std::vector<Draft> drafts;
  for (const std::size_t h : order) {
    if (best[h] < survivors.floor()) break;
    sums.restart(alike);
    const double most = best[h] - survivors.floor();
    for (const std::uint32_t p : all.varied) {
      const std::uint32_t v = all.of_hypothesis[h * n + p];
      if (first_loss[v] <= most) join(v, most, sums);
    }
    for (std::size_t k = 0; k < sums.sums().size(); ++k) {
      const double weight = best[h] - sums.sums()[k].loss;
      if (weight < survivors.floor()) break;
      if (k > 0) survivors.add(weight);
      drafts.push_back({h, k, weight, sums.sums()[k]});
    }
  }
  std::sort(drafts.begin(), drafts.end(), [](const Draft& a, const Draft& b) {
    if (a.log_weight != b.log_weight) return a.log_weight > b.log_weight;
    return a.parent != b.parent ? a.parent < b.parent : a.rank < b.rank;
  });
  while (!drafts.empty() && (drafts.size() > limits.slots ||
                             drafts.back().log_weight < drafts.front().log_weight - limits.span))
    drafts.pop_back();

  const auto write = [&](std::uint32_t variant, std::size_t rank, Association& a) {
    const Causes causes = variants[variant].causes(rank);
    const auto& measurements = parts.measurements[variants[variant].part];
    for (std::size_t i = 0; i < causes.size(); ++i) {
      if (causes[i] >= 0 || rank > 0)
        a.cause[measurements[i]] = causes[i] >= 0 ? causes[i] : base.cause[measurements[i]];
    }
  };
  Association common = base;
  for (std::size_t p = 0; p < n; ++p) write(all.of_hypothesis[p], 0, common);
  std::vector<RankedChild> children(drafts.size());
  parallelFor(drafts.size(), [&](std::size_t i) {
    const Draft& d = drafts[i];
    Association a = common;
    for (const std::uint32_t p : all.varied) {
      const std::uint32_t v = all.of_hypothesis[d.parent * n + p];
      if (v == all.of_hypothesis[p]) continue;
      for (const std::size_t m : parts.measurements[p]) a.cause[m] = base.cause[m];
      write(v, 0, a);
    }
    sums.forEachChange(
        d.sum, [&](std::uint32_t v, std::uint32_t alternative) { write(v, alternative + 1, a); });
    a.log_weight = d.log_weight - log_weights[d.parent];
    children[i] = {d.parent, std::move(a), d.log_weight};
  });
  return children;
}

}  // namespace perception
