#pragma once
#include <cstdint>
#include <vector>

#include "libperception/lidar/classification/ClusterClassifier.h"

namespace perception {

/// A descriptor with its true kind.
struct TrainingSample {
  const Descriptor* descriptor = nullptr;  ///< not owned
  ClusterKind kind = ClusterKind::kThing;
  double weight = 1;  ///< 0: as if it were not there
};

/// Weights of about 1 are assumed by `l2` and `min_leaf_weight`.
struct TreeTrainingParams {
  int rounds = 120;               ///< one tree for each kind in every round
  double learning_rate = 0.08;    ///< by which the values of the leaves are multiplied
  int leaves = 12;                ///< of a tree, at most
  double l2 = 1;                  ///< added to the sum of second derivatives of a leaf
  double min_leaf_weight = 1e-3;  ///< sum of second derivatives in a leaf, at least
  int min_leaf_samples = 20;
  int bins = 255;              ///< of a feature's values, 2 to 255
  double feature_share = 0.5;  ///< of the features that a tree may use, drawn for each tree
  double sample_share = 0.7;   ///< of the samples that a round learns from, drawn for each round
  std::uint64_t seed = 1;
};

/// Fits boosted trees to the multinomial log loss [friedman2001], each leaf by one Newton step.
/// Splits are searched in histograms of binned values; the leaf with the greatest gain is split
/// first. The result does not depend on the number of threads. Throws DataError if there is no
/// sample with weight and Error if a parameter is out of range.
BoostedTrees trainTrees(const std::vector<TrainingSample>& samples,
                        const TreeTrainingParams& params);

}  // namespace perception
