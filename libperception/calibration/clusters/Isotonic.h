#pragma once
#include <vector>

#include "libperception/lidar/classification/ClusterClassifier.h"

namespace perception {

/// Isotonic map of raw probabilities to those of a class: the ascending step function with the
/// least weighted sum of squares, by pooling of adjacent violators [ayer1955]. Each step gives a
/// knot at its first and its last value. The probabilities are limited to [0.002, 0.995], so that
/// no value is taken for certain; of more than 32 steps the most alike neighbors are joined.
/// `values`: raw probabilities; `is_class`, `weights`: of the same size; samples without weight
/// have no effect. Throws Error if sizes differ.
std::vector<Knot> isotonic(const std::vector<double>& values, const std::vector<bool>& is_class,
                           const std::vector<double>& weights);

}  // namespace perception
