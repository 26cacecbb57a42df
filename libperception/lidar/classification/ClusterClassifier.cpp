#include "libperception/lidar/classification/ClusterClassifier.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libperception/lidar/classification/LeafMasks.h"

namespace perception {
namespace {

constexpr double kIsotonicShare = 0.9;       // the rest keeps what the map makes equal in order
constexpr double kMostEvidence = 6;          // |log ratio|: 400 to 1
constexpr double kLeastProbability = 1e-12;  // keeps logs finite
/// EvidenceMemory::few_of_pedestrian of models that know real posts and trunks (chosen on left-out
/// recordings: docs/decisions/lidar.md). Simulated ones hardly look like people.
constexpr double kFewOfPedestrian = 25;
constexpr auto kThing = static_cast<std::size_t>(ClusterKind::kThing);
constexpr auto kPhantom = static_cast<std::size_t>(ClusterKind::kPhantom);
constexpr auto kMixed = static_cast<std::size_t>(ClusterKind::kMixed);

/// Without a branch: that would often be foreseen wrongly.
std::size_t childOf(const BoostedTrees::Node& node, const Descriptor& descriptor) {
  const bool left = descriptor[static_cast<std::size_t>(node.feature)] <= node.threshold;
  const std::int32_t mask = -static_cast<std::int32_t>(left);
  return static_cast<std::size_t>((node.left & mask) | (node.right & ~mask));
}

}  // namespace

float BoostedTrees::leafValue(std::int32_t root, const Descriptor& descriptor) const {
  const Node* node = &nodes[static_cast<std::size_t>(root)];
  while (node->feature >= 0) node = &nodes[childOf(*node, descriptor)];
  return node->threshold;
}

void BoostedTrees::scores(const Descriptor& descriptor, double (&out)[kClusterKinds]) const {
  for (std::size_t k = 0; k < kClusterKinds; ++k) out[k] = base[k];
  for (std::size_t t = 0; t + kClusterKinds <= roots.size(); t += kClusterKinds)
    for (std::size_t k = 0; k < kClusterKinds; ++k)
      out[k] += static_cast<double>(leafValue(roots[t + k], descriptor));
}

double Calibration::operator()(double raw) const {
  if (knots.empty()) return raw;
  const auto next = std::upper_bound(knots.begin(), knots.end(), raw,
                                     [](double r, const Knot& knot) { return r < knot.raw; });
  if (next == knots.begin()) return knots.front().calibrated;
  if (next == knots.end()) return knots.back().calibrated;
  const Knot &a = next[-1], &b = next[0];
  return a.calibrated + (b.calibrated - a.calibrated) * ((raw - a.raw) / (b.raw - a.raw));
}

ClusterClassifier::ClusterClassifier(BoostedTrees trees,
                                     std::array<Calibration, kClusterKinds> calibrations,
                                     const std::array<double, kClusterKinds>& prior,
                                     const EvidenceMemory& memory, Provenance provenance,
                                     KnownShapes known)
    : trees_(std::move(trees)),
      calibrations_(std::move(calibrations)),
      prior_(prior),
      memory_(memory),
      provenance_(std::move(provenance)),
      known_(std::move(known)) {
  memory_.few_of_pedestrian = provenance_.simulated_only ? 0 : kFewOfPedestrian;
  if (auto masks = LeafMasks::of(trees_)) masks_ = std::make_shared<LeafMasks>(std::move(*masks));
}

void ClusterClassifier::score(const Descriptor& descriptor, double (&out)[kClusterKinds]) const {
  masks_ ? masks_->scores(descriptor, out) : trees_.scores(descriptor, out);
}

std::array<double, kClusterKinds> ClusterClassifier::probabilities(
    const Descriptor& descriptor) const {
  double scores[kClusterKinds];
  score(descriptor, scores);
  const double highest = *std::max_element(scores, scores + kClusterKinds);
  std::array<double, kClusterKinds> p{};
  double sum = 0;
  for (std::size_t k = 0; k < kClusterKinds; ++k) sum += p[k] = std::exp(scores[k] - highest);
  double mapped = 0;
  for (std::size_t k = 0; k < kClusterKinds; ++k) {
    const double raw = p[k] / sum;
    mapped += p[k] = kIsotonicShare * calibrations_[k](raw) + (1 - kIsotonicShare) * raw;
  }
  for (double& v : p) v /= mapped;
  return p;
}

std::array<double, kShapes> ClusterClassifier::evidence(
    const std::array<double, kClusterKinds>& p) const {
  const auto likelihood = [](double probability, double prior) {
    return std::log(std::max(probability, kLeastProbability) / prior);
  };
  const double no_road_user =
      likelihood(p[kThing] + p[kPhantom], prior_[kThing] + prior_[kPhantom]);
  std::array<double, kShapes> evidence{};
  for (std::size_t k = 0; k < kShapes; ++k) {
    if (k == kThing) continue;
    const double ratio = likelihood(p[k], prior_[k]) - no_road_user;
    evidence[k] = std::clamp(ratio, -kMostEvidence, kMostEvidence) * (1 - p[kMixed]);
  }
  return evidence;
}

double ClusterClassifier::phantomEvidence(const std::array<double, kClusterKinds>& p) const {
  const auto logOdds = [](double q) {
    const double bounded = std::clamp(q, kLeastProbability, 1 - kLeastProbability);
    return std::log(bounded / (1 - bounded));
  };
  const double ratio = logOdds(p[kPhantom]) - logOdds(prior_[kPhantom]);
  return std::clamp(ratio, -kMostEvidence, kMostEvidence) * (1 - p[kMixed]);
}

}  // namespace perception
