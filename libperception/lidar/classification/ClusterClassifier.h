#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "libperception/lidar/classification/KnownShapes.h"
#include "libperception/lidar/description/ClusterDescriptor.h"
#include "libperception/lidar/description/ClusterKind.h"
#include "libperception/measurement/objects/EvidenceMemory.h"

namespace perception {

/// Sums of regression trees, one sum for each kind; their softmax are probabilities
/// (gradient boosting [friedman2001]).
struct BoostedTrees {
  struct Node {
    std::int16_t feature = -1;  ///< index of a Feature; -1: a leaf
    float threshold = 0;        ///< values up to it go left; of a leaf: what it adds to the score
    std::int32_t left = 0, right = 0;  ///< indices into `nodes`, greater than that of this node
  };
  std::array<double, kClusterKinds> base{};  ///< scores before the first tree
  std::vector<std::int32_t> roots;           ///< indices into `nodes`; tree i is of kind i % 6
  std::vector<Node> nodes;                   ///< tree by tree

  /// Scores (unnormalized log probabilities) of all kinds.
  void scores(const Descriptor& descriptor, double (&out)[kClusterKinds]) const;
  /// What one tree adds for this descriptor.
  float leafValue(std::int32_t root, const Descriptor& descriptor) const;
};

/// The probability to which a raw one is mapped.
struct Knot {
  double raw = 0, calibrated = 0;  ///< both in [0, 1]
};

/// Isotonic map of a raw probability: linear between the knots, constant outside of them. No knots:
/// unchanged.
struct Calibration {
  std::vector<Knot> knots;  ///< `raw` ascending, `calibrated` not descending
  double operator()(double raw) const;
};

/// Where a classifier comes from.
struct Provenance {
  std::string version, date, license;
  std::vector<std::string> data;  ///< names of the recordings that it learned from
  bool simulated_only = false;    ///< none of them is real
};

class LeafMasks;

/// Tells kinds of clusters from their descriptors. Safe for several threads.
class ClusterClassifier {
 public:
  /// `prior`: share of each kind among the samples for which the probabilities hold.
  ClusterClassifier(BoostedTrees trees, std::array<Calibration, kClusterKinds> calibrations,
                    const std::array<double, kClusterKinds>& prior, const EvidenceMemory& memory,
                    Provenance provenance, KnownShapes known = {});

  /// Calibrated probabilities of the kinds; their sum is 1.
  std::array<double, kClusterKinds> probabilities(const Descriptor& descriptor) const;

  /// log p(descriptor | kind) / p(descriptor | thing or phantom), by Bayes' rule from the
  /// probabilities and the prior; 0 for a thing. Limited to +-6 and then multiplied by 1 -
  /// P(mixed): the shape of several objects grown together tells little of any one of them.
  std::array<double, kShapes> evidence(const Descriptor& descriptor) const {
    return evidence(probabilities(descriptor));
  }
  std::array<double, kShapes> evidence(
      const std::array<double, kClusterKinds>& probabilities) const;

  /// log p(descriptor | phantom) / p(descriptor | anything else), limited likewise.
  double phantomEvidence(const std::array<double, kClusterKinds>& probabilities) const;

  /// Reads a file as of write(). Nothing in it is trusted: throws DataError with the place of the
  /// first fault and what was expected there.
  static ClusterClassifier read(const std::string& file);
  /// Like read(), of a text; `name` stands for it in messages.
  static ClusterClassifier parse(const std::string& text, const std::string& name);

  /// JSON with one tree a line, from which read() gets the same numbers. A node is
  /// [feature, threshold, left, right] with indices in its tree, a leaf is [value].
  std::string write() const;

  const BoostedTrees& trees() const { return trees_; }
  const std::array<Calibration, kClusterKinds>& calibrations() const { return calibrations_; }
  const std::array<double, kClusterKinds>& prior() const { return prior_; }
  const EvidenceMemory& memory() const { return memory_; }
  const Provenance& provenance() const { return provenance_; }
  const KnownShapes& known() const { return known_; }

 private:
  void score(const Descriptor& descriptor, double (&out)[kClusterKinds]) const;

  BoostedTrees trees_;
  std::shared_ptr<const LeafMasks> masks_;  ///< of the same trees; null: they have too many leaves
  std::array<Calibration, kClusterKinds> calibrations_;
  std::array<double, kClusterKinds> prior_;
  EvidenceMemory memory_;
  Provenance provenance_;
  KnownShapes known_;
};

}  // namespace perception
