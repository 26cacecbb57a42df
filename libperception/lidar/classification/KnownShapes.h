#pragma once
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "libperception/lidar/description/ClusterDescriptor.h"
#include "libperception/lidar/description/ClusterKind.h"

namespace perception {

class JsonItem;

/// How far a cluster's geometry lies from what a model has learned a kind from. Far from all of it
/// the model guesses, so that its evidence for the kind counts less there (method.md 8.10). Novelty
/// by the distance to the nearest neighbors [ramaswamy2000].
class KnownShapes {
 public:
  /// Logs of lengths [m] and of the roughness [-].
  static constexpr std::array<Feature, 6> kFeaturesUsed = {
      Feature::kLength, Feature::kWidth,  Feature::kEdgeDistance,
      Feature::kWidth5, Feature::kWidth3, Feature::kRoughness};
  using Geometry = std::array<float, kFeaturesUsed.size()>;
  static Geometry geometryOf(const Descriptor& descriptor);

  /// What is known of a kind.
  struct OfKind {
    double within = 0;  ///< distance up to which a cluster counts as known, > 0; 0: not asked
    Geometry scale{};   ///< deviation of each feature over the examples, > 0
    std::vector<Geometry> examples;

    /// Of two geometries, in deviations by feature (root mean square).
    double distance(const Geometry& a, const Geometry& b) const;
    /// Mean of those to the three nearest examples; infinite with fewer than three.
    double distance(const Geometry& geometry) const;
  };

  /// Factor in [0, 1] of what speaks for a road user of this kind: 1 up to the distance `within`, 0
  /// from twice that on, 1 for kinds of which nothing is stored.
  double weight(ClusterKind kind, const Descriptor& descriptor) const;
  /// Of the kinds that `evidence`, log likelihoods by kind, speaks for; 1 for the others.
  std::array<double, kRoadUsers> weights(const Descriptor& descriptor,
                                         const std::array<double, kShapes>& evidence) const;

  /// JSON as of text(). Throws DataError with the place of the first fault and what was expected.
  static KnownShapes read(const JsonItem& item);
  /// An object with a member for each kind that is known; empty: none is.
  std::string text() const;

  OfKind& of(std::size_t kind) { return kinds_[kind]; }
  const OfKind& of(std::size_t kind) const { return kinds_[kind]; }

 private:
  std::array<OfKind, kRoadUsers> kinds_;
};

}  // namespace perception
