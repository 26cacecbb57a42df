#include "libperception/calibration/clusters/TreeTraining.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "libperception/calibration/clusters/BinnedSamples.h"
#include "libperception/core/Error.h"
#include "libperception/core/math/Random.h"

namespace perception {
namespace {

constexpr std::uint32_t kSamplePurpose = 0x7EE51, kFeaturePurpose = 0x7EE52;  // of random numbers
constexpr double kLeastShare = 1e-9;  // of a kind without samples: keeps its base score finite
constexpr std::size_t kMostBins = 256, kManyRows = 2000;
constexpr double kLeastGain = 1e-10;  // what rounding errors can pretend

using Rows = std::vector<std::uint32_t>;

/// `count` of the numbers below `of`, ascending, all sets equally likely (selection sampling).
Rows drawn(std::size_t count, std::size_t of, Rng&& rng) {
  Rows out;
  out.reserve(count);
  for (std::size_t i = 0; i < of && out.size() < count; ++i)
    if (rng.below(static_cast<std::uint32_t>(of - i)) < count - out.size())
      out.push_back(static_cast<std::uint32_t>(i));
  return out;
}

std::size_t shareOf(double share, std::size_t count) {
  return std::clamp<std::size_t>(
      static_cast<std::size_t>(std::ceil(share * static_cast<double>(count))), 1, count);
}

/// Sums over samples: first and second derivatives of the loss, number.
struct Sums {
  double gradient = 0, hessian = 0;
  std::uint64_t count = 0;
  Sums& operator+=(const Sums& o) {
    gradient += o.gradient, hessian += o.hessian, count += o.count;
    return *this;
  }
  Sums operator-(const Sums& o) const {
    return {gradient - o.gradient, hessian - o.hessian, count - o.count};
  }
};

struct Derivatives {
  double gradient = 0, hessian = 0;
};

struct Split {
  double gain = 0;
  std::size_t feature = 0, bin = 0;  ///< values up to this bin go left
  Sums left;
};

/// Grows one tree at a time.
class TreeGrower {
 public:
  TreeGrower(const BinnedSamples& binned, const TreeTrainingParams& params)
      : binned_(binned), params_(params) {}

  /// Appends the tree for the derivatives of the loss at all samples; learns from `rows` alone.
  void grow(const Rows& rows, const Rows& features, const std::vector<Derivatives>& derivatives,
            BoostedTrees& trees) {
    rows_ = rows;
    features_ = &features;
    derivatives_ = &derivatives;
    leaves_.clear();
    trees.roots.push_back(static_cast<std::int32_t>(trees.nodes.size()));
    trees.nodes.emplace_back();
    Leaf root{trees.nodes.size() - 1, 0, rows.size(), {}, {}, {}};
    for (const std::uint32_t i : rows)
      root.sums += {derivatives[i].gradient, derivatives[i].hessian, 1};
    root.histogram = histogramOf(root);
    findSplit(root);
    leaves_.push_back(std::move(root));
    while (leaves_.size() < static_cast<std::size_t>(params_.leaves)) {
      const auto best = std::max_element(
          leaves_.begin(), leaves_.end(),
          [](const Leaf& a, const Leaf& b) { return a.split.gain < b.split.gain; });
      if (!(best->split.gain > 0)) break;
      divide(static_cast<std::size_t>(best - leaves_.begin()), trees);
    }
    for (const Leaf& leaf : leaves_)
      trees.nodes[leaf.node].threshold =
          static_cast<float>(-params_.learning_rate * leaf.sums.gradient /
                             std::max(leaf.sums.hessian + params_.l2, 1e-12));
  }

 private:
  using Histogram = std::vector<Sums>;  ///< by place in features_, then by bin

  struct Leaf {
    std::size_t node, begin, end;  ///< its node; its part of rows_
    Sums sums;
    Histogram histogram;
    Split split;
  };

  /// Calls `work` for every place in features_.
  template <class Work>
  void forFeatures(std::size_t rows, const Work& work) const {
    if (rows < kManyRows) {
      for (std::size_t p = 0; p < features_->size(); ++p) work(p);
    } else {
      tbb::parallel_for(std::size_t{0}, features_->size(), work);
    }
  }

  Histogram histogramOf(const Leaf& leaf) {
    const std::size_t rows = leaf.end - leaf.begin;
    gathered_.resize(rows);
    for (std::size_t r = 0; r < rows; ++r) gathered_[r] = (*derivatives_)[rows_[leaf.begin + r]];
    Histogram histogram(features_->size() * kMostBins);
    forFeatures(rows, [&](std::size_t p) {
      const std::uint8_t* column = binned_.column((*features_)[p]);
      Sums* sums = &histogram[p * kMostBins];
      for (std::size_t r = 0; r < rows; ++r)
        sums[column[rows_[leaf.begin + r]]] += {gathered_[r].gradient, gathered_[r].hessian, 1};
    });
    return histogram;
  }

  double score(const Sums& s) const { return s.gradient * s.gradient / (s.hessian + params_.l2); }
  bool isLeaf(const Sums& s) const {
    return s.hessian >= params_.min_leaf_weight &&
           s.count >= static_cast<std::uint64_t>(params_.min_leaf_samples);
  }

  Split bestOf(const Leaf& leaf, std::size_t p) const {
    Split best;
    best.feature = (*features_)[p];
    const std::size_t cuts = binned_.thresholds[best.feature].size();
    const Sums* bins = &leaf.histogram[p * kMostBins];
    const double whole = score(leaf.sums);
    Sums left;
    for (std::size_t b = 0; b < cuts; ++b) {
      if (bins[b].count == 0) continue;
      left += bins[b];
      const Sums right = leaf.sums - left;
      if (!isLeaf(left)) continue;
      if (!isLeaf(right)) {
        if (right.count < static_cast<std::uint64_t>(params_.min_leaf_samples)) break;
        continue;
      }
      const double gain = score(left) + score(right) - whole;
      if (gain > std::max(best.gain, kLeastGain)) best.gain = gain, best.bin = b, best.left = left;
    }
    return best;
  }

  void findSplit(Leaf& leaf) const {
    const auto fewest = 2 * static_cast<std::size_t>(params_.min_leaf_samples);
    if (leaf.end - leaf.begin < fewest) return;
    std::vector<Split> best(features_->size());
    forFeatures(leaf.end - leaf.begin, [&](std::size_t p) { best[p] = bestOf(leaf, p); });
    for (const Split& split : best)
      if (split.gain > leaf.split.gain) leaf.split = split;
  }

  void divide(std::size_t index, BoostedTrees& trees) {
    Leaf& leaf = leaves_[index];
    const Split split = leaf.split;
    const std::uint8_t* column = binned_.column(split.feature);
    const auto begin = rows_.begin() + static_cast<std::ptrdiff_t>(leaf.begin);
    const auto end = rows_.begin() + static_cast<std::ptrdiff_t>(leaf.end);
    const auto middle = static_cast<std::size_t>(
        std::stable_partition(begin, end, [&](std::uint32_t i) { return column[i] <= split.bin; }) -
        rows_.begin());
    const std::size_t node = trees.nodes.size();
    trees.nodes.resize(node + 2);
    BoostedTrees::Node& parent = trees.nodes[leaf.node];
    parent.feature = static_cast<std::int16_t>(split.feature);
    parent.threshold = binned_.thresholds[split.feature][split.bin];
    parent.left = static_cast<std::int32_t>(node);
    parent.right = static_cast<std::int32_t>(node + 1);
    Leaf left{node, leaf.begin, middle, split.left, {}, {}};
    Leaf right{node + 1, middle, leaf.end, leaf.sums - split.left, {}, {}};
    // The last leaves need no histograms.
    if (leaves_.size() + 1 < static_cast<std::size_t>(params_.leaves)) {
      const bool left_is_smaller = left.end - left.begin <= right.end - right.begin;
      Leaf& smaller = left_is_smaller ? left : right;
      Leaf& larger = left_is_smaller ? right : left;
      smaller.histogram = histogramOf(smaller);
      larger.histogram = std::move(leaf.histogram);
      for (std::size_t b = 0; b < larger.histogram.size(); ++b)
        larger.histogram[b] = larger.histogram[b] - smaller.histogram[b];
      findSplit(left);
      findSplit(right);
    }
    leaves_[index] = std::move(left);
    leaves_.push_back(std::move(right));
  }

  const BinnedSamples& binned_;
  const TreeTrainingParams& params_;
  Rows rows_;  ///< those of a leaf side by side, ascending
  const Rows* features_ = nullptr;
  const std::vector<Derivatives>* derivatives_ = nullptr;
  std::vector<Leaf> leaves_;
  std::vector<Derivatives> gathered_;  ///< of the rows of one leaf, in their order
};

using Scores = std::vector<std::array<double, kClusterKinds>>;

/// Derivatives of the weighted log loss to each kind's score, at all samples.
void derive(const std::vector<TrainingSample>& samples, const Scores& scores,
            std::array<std::vector<Derivatives>, kClusterKinds>& out) {
  for (auto& of_kind : out) of_kind.resize(samples.size());
  tbb::parallel_for(std::size_t{0}, samples.size(), [&](std::size_t i) {
    const auto& score = scores[i];
    const double highest = *std::max_element(score.begin(), score.end());
    std::array<double, kClusterKinds> p{};
    double sum = 0;
    for (std::size_t k = 0; k < kClusterKinds; ++k) sum += p[k] = std::exp(score[k] - highest);
    for (std::size_t k = 0; k < kClusterKinds; ++k) {
      p[k] /= sum;
      const double truth = static_cast<std::size_t>(samples[i].kind) == k ? 1 : 0;
      out[k][i] = {samples[i].weight * (p[k] - truth), samples[i].weight * p[k] * (1 - p[k])};
    }
  });
}

void check(const TreeTrainingParams& p) {
  const auto isShare = [](double share) { return share > 0 && share <= 1; };
  if (p.rounds < 1 || !(p.learning_rate > 0) || p.leaves < 2 || !(p.l2 >= 0) ||
      !(p.min_leaf_weight >= 0) || p.min_leaf_samples < 1 || p.bins < 2 || p.bins > 255 ||
      !isShare(p.feature_share) || !isShare(p.sample_share))
    throw Error(ExitCode::kInternal, "training of trees: a parameter is out of range");
}

}  // namespace

BoostedTrees trainTrees(const std::vector<TrainingSample>& all, const TreeTrainingParams& params) {
  check(params);
  std::vector<TrainingSample> samples;
  std::array<double, kClusterKinds> weight{};
  double sum = 0;
  for (const TrainingSample& s : all) {
    if (!(s.weight > 0)) continue;
    samples.push_back(s);
    weight[static_cast<std::size_t>(s.kind)] += s.weight, sum += s.weight;
  }
  if (samples.empty()) throw DataError("training of trees: no sample");
  BoostedTrees trees;
  for (std::size_t k = 0; k < kClusterKinds; ++k)
    trees.base[k] = std::log(std::max(weight[k] / sum, kLeastShare));
  Scores scores(samples.size(), trees.base);
  std::array<std::vector<Derivatives>, kClusterKinds> derivatives;
  const BinnedSamples binned(samples, static_cast<std::size_t>(params.bins));
  TreeGrower grower(binned, params);
  for (std::uint32_t round = 0; round < static_cast<std::uint32_t>(params.rounds); ++round) {
    derive(samples, scores, derivatives);
    const Rows rows = drawn(shareOf(params.sample_share, samples.size()), samples.size(),
                            Rng({params.seed, round, 0, kSamplePurpose}));
    for (std::uint32_t k = 0; k < kClusterKinds; ++k) {
      const Rows features = drawn(shareOf(params.feature_share, kFeatures), kFeatures,
                                  Rng({params.seed, round, k, kFeaturePurpose}));
      grower.grow(rows, features, derivatives[k], trees);
      tbb::parallel_for(std::size_t{0}, samples.size(), [&](std::size_t i) {
        const float value = trees.leafValue(trees.roots.back(), *samples[i].descriptor);
        scores[i][k] += static_cast<double>(value);
      });
    }
  }
  return trees;
}

}  // namespace perception
