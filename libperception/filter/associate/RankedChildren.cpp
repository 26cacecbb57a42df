#include "libperception/filter/associate/RankedChildren.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>
#include <queue>
#include <utility>

#include "libperception/core/math/LogMath.h"
#include "libperception/core/system/Parallel.h"
#include "libperception/filter/associate/RankedSums.h"
#include "libperception/filter/associate/ScanParts.h"

namespace perception {
namespace {

/// A child whose causes are not yet listed.
struct Draft {
  std::size_t parent;
  std::size_t rank;  // among the children of the parent
  double log_weight;
  RankedSums::Sum sum;
};

/// The best `slots` weights so far: children below are pruned.
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

/// Pass 3 of one scan, step by step.
class Ranking {
 public:
  Ranking(const std::vector<TrackIndices>& tracks, const std::vector<double>& log_weights,
          const AssociationIndex& index, const RankingLimits& limits)
      : log_weights_(log_weights),
        limits_(limits),
        parts_(index),
        all_(tracks, parts_),
        sums_(limits.children) {
    parallelFor(all_.variants.size(),
                [&](std::size_t v) { solveBest(parts_, tracks, index, all_.variants[v]); });
    setBest(tracks, index);
    order_.resize(tracks.size());
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::stable_sort(order_.begin(), order_.end(),
                     [&](std::size_t a, std::size_t b) { return best_[a] > best_[b]; });
  }

  std::vector<RankedChild> children() {
    Survivors survivors(limits_.slots, best_[order_.front()] - limits_.span);
    for (const double weight : best_) survivors.add(weight);
    rankVariants(survivors.floor());
    const std::vector<Draft> kept = drafts(survivors);
    std::vector<RankedChild> out(kept.size());
    parallelFor(kept.size(), [&](std::size_t i) { out[i] = written(kept[i]); });
    return out;
  }

 private:
  std::uint32_t variantOf(std::size_t h, std::size_t part) const {
    return all_.of_hypothesis[h * parts_.measurements.size() + part];
  }

  /// The best association of every hypothesis, and the part common to all.
  void setBest(const std::vector<TrackIndices>& tracks, const AssociationIndex& index) {
    for (std::size_t m = 0; m < index.measurements(); ++m) {
      const auto& other = likeliestOther(index, m);
      nothing_.cause.push_back(other.cause);
      if (other.log_weight > kMinusInfinity) nothing_.log_weight += other.log_weight;
    }
    std::vector<double> gain;
    for (const auto& v : all_.variants) gain.push_back(v.ranking->best().log_weight);
    const std::size_t parts = parts_.measurements.size();
    for (std::size_t h = 0; h < tracks.size(); ++h) {
      double weight = 0;
      for (const std::uint32_t t : tracks[h]) weight += index.logMiss(t);
      weight += nothing_.log_weight;
      for (std::size_t p = 0; p < parts; ++p) weight += gain[variantOf(h, p)];
      best_.push_back(weight + log_weights_[h]);
    }
    alike_ = nothing_;
    for (std::size_t p = 0; p < parts; ++p) write(variantOf(0, p), 0, alike_);
  }

  /// Computes the alternatives of the variants that may be within the pruning limit in some
  /// hypothesis.
  void rankVariants(double floor) {
    auto& variants = all_.variants;
    std::vector<double> afforded(variants.size(), kMinusInfinity);
    for (const std::size_t h : order_) {
      if (best_[h] < floor) break;
      for (std::size_t p = 0; p < parts_.measurements.size(); ++p) {
        double& loss = afforded[variantOf(h, p)];
        loss = std::max(loss, best_[h] - floor);
      }
    }
    parallelFor(variants.size(), [&](std::size_t i) {
      PartVariant& v = variants[i];
      if (afforded[i] < 0) return;
      const auto ranked = v.ranking->rank(limits_.children, afforded[i]);
      for (std::size_t k = 1; k < ranked.size(); ++k) {
        v.losses.push_back(ranked[0].log_weight - ranked[k].log_weight);
        v.addCauses(ranked[k].column);
      }
    });
  }

  void join(std::uint32_t variant, double limit) {
    const auto& losses = all_.variants[variant].losses;
    sums_.join(variant, losses.data(), losses.size(), limit);
  }

  /// The remaining children, best first. Hypotheses are processed by weight, so that the pruning
  /// limit tightens early; parts common to all hypotheses are merged once.
  std::vector<Draft> drafts(Survivors& survivors) {
    std::vector<char> varies(parts_.measurements.size(), 0);
    for (const std::uint32_t p : all_.varied) varies[p] = 1;
    for (std::size_t p = 0; p < varies.size(); ++p)
      if (!varies[p]) join(variantOf(0, p), best_[order_.front()] - survivors.floor());
    std::vector<double> first_loss(all_.variants.size(), std::numeric_limits<double>::infinity());
    for (std::size_t v = 0; v < first_loss.size(); ++v)
      if (!all_.variants[v].losses.empty()) first_loss[v] = all_.variants[v].losses.front();

    const std::vector<RankedSums::Sum> alike = sums_.sums();
    std::vector<Draft> out;
    for (const std::size_t h : order_) {
      const double most = best_[h] - survivors.floor();
      if (most < 0) break;
      sums_.restart(alike);
      for (const std::uint32_t p : all_.varied)
        if (first_loss[variantOf(h, p)] <= most) join(variantOf(h, p), most);
      for (std::size_t k = 0; k < sums_.sums().size(); ++k) {
        const double weight = best_[h] - sums_.sums()[k].loss;
        if (weight < survivors.floor()) break;
        if (k > 0) survivors.add(weight);
        out.push_back({h, k, weight, sums_.sums()[k]});
      }
    }
    std::sort(out.begin(), out.end(), [](const Draft& a, const Draft& b) {
      if (a.log_weight != b.log_weight) return a.log_weight > b.log_weight;
      return a.parent != b.parent ? a.parent < b.parent : a.rank < b.rank;
    });
    const double least = out.front().log_weight - limits_.span;
    while (out.size() > limits_.slots || out.back().log_weight < least) out.pop_back();
    return out;
  }

  void write(std::uint32_t variant, std::size_t rank, Association& a) const {
    const Causes& causes = all_.variants[variant].causes[rank];
    const auto& measurements = parts_.measurements[all_.variants[variant].part];
    for (std::size_t i = 0; i < causes.size(); ++i)
      a.cause[measurements[i]] = causes[i] >= 0 ? causes[i] : nothing_.cause[measurements[i]];
  }

  RankedChild written(const Draft& d) const {
    Association a = alike_;
    for (const std::uint32_t p : all_.varied) {
      const std::uint32_t v = variantOf(d.parent, p);
      if (v != variantOf(0, p)) write(v, 0, a);
    }
    sums_.forEachChange(
        d.sum, [&](std::uint32_t v, std::uint32_t alternative) { write(v, alternative + 1, a); });
    a.log_weight = d.log_weight - log_weights_[d.parent];
    return {d.parent, std::move(a), d.log_weight};
  }

  const std::vector<double>& log_weights_;  // by hypothesis
  const RankingLimits& limits_;
  ScanParts parts_;
  PartVariants all_;
  Association nothing_;             // no measurement is of a track
  Association alike_;               // the best of the first hypothesis
  std::vector<double> best_;        // log weight of each hypothesis's likeliest child
  std::vector<std::size_t> order_;  // hypotheses, likeliest child first
  RankedSums sums_;
};

}  // namespace

std::vector<RankedChild> rankChildren(const std::vector<TrackIndices>& tracks,
                                      const std::vector<double>& log_weights,
                                      const AssociationIndex& index, const RankingLimits& limits) {
  return Ranking(tracks, log_weights, index, limits).children();
}

}  // namespace perception
