#include "libperception/calibration/clusters/TreeTraining.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libperception/core/Error.h"
#include "libperception/core/math/Random.h"

namespace perception {
namespace {

struct Samples {
  std::vector<Descriptor> descriptors;
  std::vector<TrainingSample> list;

  void add(const Descriptor& d, ClusterKind kind, double weight = 1) {
    descriptors.push_back(d);
    list.push_back({nullptr, kind, weight});
  }
  const std::vector<TrainingSample>& samples() {
    for (std::size_t i = 0; i < list.size(); ++i) list[i].descriptor = &descriptors[i];
    return list;
  }
};

Descriptor noise(Rng& rng) {
  Descriptor d;
  for (float& v : d) v = static_cast<float>(rng.normal());
  return d;
}

/// A pedestrian if just one of two features is positive, else a thing.
Samples exclusiveOr(int count, std::uint64_t seed) {
  Rng rng(RngKey{seed, 0, 0, 11});
  Samples out;
  for (int i = 0; i < count; ++i) {
    const Descriptor d = noise(rng);
    out.add(d, (d[3] > 0) != (d[7] > 0) ? ClusterKind::kPedestrian : ClusterKind::kThing);
  }
  return out;
}

TreeTrainingParams quick() {
  TreeTrainingParams params;
  params.rounds = 40;
  return params;
}

ClusterKind likeliest(const BoostedTrees& trees, const Descriptor& d) {
  double scores[kClusterKinds];
  trees.scores(d, scores);
  return static_cast<ClusterKind>(std::max_element(scores, scores + kClusterKinds) - scores);
}

double shareRight(const BoostedTrees& trees, const Samples& samples) {
  double right = 0;
  for (std::size_t i = 0; i < samples.list.size(); ++i)
    right += likeliest(trees, samples.descriptors[i]) == samples.list[i].kind ? 1 : 0;
  return right / static_cast<double>(samples.list.size());
}

std::string bytes(const BoostedTrees& trees) {
  return ClusterClassifier(trees, {}, {0.2, 0.2, 0.2, 0.2, 0.1, 0.1}, {}, {}).write();
}

TEST(TreeTraining, LearnsTheExclusiveOrOfTwoFeatures) {
  Samples samples = exclusiveOr(4000, 1);
  TreeTrainingParams params = quick();
  params.feature_share = 1;
  const Samples others = exclusiveOr(1000, 2);
  EXPECT_GT(shareRight(trainTrees(samples.samples(), params), others), 0.97);
  params.leaves = 2;  // trees of one split cannot
  EXPECT_LT(shareRight(trainTrees(samples.samples(), params), others), 0.65);
}

TEST(TreeTraining, GivesTheSameBytesForTheSameSeedAndAnyNumberOfThreads) {
  Samples samples = exclusiveOr(6000, 1);
  TreeTrainingParams params = quick();
  params.rounds = 5;
  const std::string first = bytes(trainTrees(samples.samples(), params));
  EXPECT_EQ(bytes(trainTrees(samples.samples(), params)), first);
  {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(bytes(trainTrees(samples.samples(), params)), first);
  }
  params.seed = 2;
  EXPECT_NE(bytes(trainTrees(samples.samples(), params)), first);
}

TEST(TreeTraining, MakesTreesThatTheReaderAccepts) {
  Samples samples = exclusiveOr(2000, 1);
  const BoostedTrees trees = trainTrees(samples.samples(), quick());
  EXPECT_EQ(trees.roots.size(), 40 * kClusterKinds);
  const std::string text = bytes(trees);
  EXPECT_EQ(ClusterClassifier::parse(text, "model.json").write(), text);
}

TEST(TreeTraining, StartsFromTheWeightedShares) {
  Samples samples;
  samples.add({}, ClusterKind::kPedestrian, 3);
  samples.add({}, ClusterKind::kVehicle, 1);
  const BoostedTrees trees = trainTrees(samples.samples(), quick());
  EXPECT_NEAR(std::exp(trees.base[0]), 0.75, 1e-15);
  EXPECT_NEAR(std::exp(trees.base[2]), 0.25, 1e-15);
  EXPECT_TRUE(std::isfinite(trees.base[1]));  // a kind without samples
}

TEST(TreeTraining, AFirstLeafIsANewtonStep) {
  Samples samples;
  for (int i = 0; i < 100; ++i) {
    Descriptor d{};
    d[5] = i < 50 ? 1.0F : 2.0F;
    samples.add(d, i < 50 ? ClusterKind::kCyclist : ClusterKind::kThing);
  }
  TreeTrainingParams params;
  params.rounds = 1, params.feature_share = params.sample_share = 1;
  const BoostedTrees trees = trainTrees(samples.samples(), params);
  const auto& root = trees.nodes[static_cast<std::size_t>(trees.roots[1])];
  ASSERT_EQ(root.feature, 5);
  EXPECT_EQ(root.threshold, 1.5F);
  // 50 samples of gradient -1/2 and of second derivative 1/4 each.
  Descriptor d{};
  EXPECT_NEAR(trees.leafValue(trees.roots[1], d), 0.08 * 25 / (12.5 + 1), 1e-7);
  d[5] = 2;
  EXPECT_NEAR(trees.leafValue(trees.roots[1], d), -0.08 * 25 / (12.5 + 1), 1e-7);
}

TEST(TreeTraining, LeavesHoldNoFewerSamplesThanAsked) {
  Samples samples;
  for (int i = 0; i < 100; ++i) {
    Descriptor d{};
    d[0] = static_cast<float>(i);
    samples.add(d, i < 10 ? ClusterKind::kCyclist : ClusterKind::kThing);
  }
  TreeTrainingParams params;
  params.rounds = 1, params.feature_share = params.sample_share = 1;
  for (const int least : {10, 20, 51}) {
    params.min_leaf_samples = least;
    const BoostedTrees trees = trainTrees(samples.samples(), params);
    const auto& root = trees.nodes[static_cast<std::size_t>(trees.roots[1])];
    if (least == 51)
      EXPECT_EQ(root.feature, -1);
    else
      EXPECT_EQ(root.threshold, static_cast<float>(least) - 0.5F);
  }
}

TEST(TreeTraining, ASampleWithoutWeightHasNoEffect) {
  Samples samples = exclusiveOr(1000, 1);
  const std::string without = bytes(trainTrees(samples.samples(), quick()));
  Descriptor far{};
  far.fill(100);
  samples.add(far, ClusterKind::kMixed, 0);
  EXPECT_EQ(bytes(trainTrees(samples.samples(), quick())), without);
}

TEST(TreeTraining, SeparatesNeighboringFloatsAndWhatIsNoNumber) {
  const float low = 1, high = std::nextafter(low, 2.0F);  // no float lies between them
  Samples samples;
  for (int i = 0; i < 30; ++i) {
    Descriptor d{};
    d[9] = low;
    samples.add(d, ClusterKind::kVehicle);
    for (const float v : {high, std::numeric_limits<float>::quiet_NaN()}) {
      d[9] = v;
      samples.add(d, ClusterKind::kThing);
    }
  }
  TreeTrainingParams params = quick();
  params.feature_share = params.sample_share = 1;
  EXPECT_EQ(shareRight(trainTrees(samples.samples(), params), samples), 1);
}

TEST(TreeTraining, RefusesNoSamplesAndSenselessParameters) {
  EXPECT_THROW(trainTrees({}, {}), DataError);
  Samples samples = exclusiveOr(10, 1);
  TreeTrainingParams params;
  params.bins = 300;
  EXPECT_THROW(trainTrees(samples.samples(), params), Error);
  params = {};
  params.sample_share = 0;
  EXPECT_THROW(trainTrees(samples.samples(), params), Error);
}

}  // namespace
}  // namespace perception
