#include "libperception/lidar/classification/ClusterClassifier.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <numeric>

#include "libperception/core/Error.h"
#include "libperception/core/math/Random.h"
#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

using Kinds = std::array<double, kClusterKinds>;
using Node = BoostedTrees::Node;

/// Trees without splits: every kind has the probability of its score.
BoostedTrees constantTrees(const Kinds& scores) {
  BoostedTrees trees;
  trees.base = scores;
  for (std::int32_t k = 0; k < static_cast<std::int32_t>(kClusterKinds); ++k) {
    trees.roots.push_back(k);
    trees.nodes.push_back({-1, 0.0F, 0, 0});
  }
  return trees;
}

ClusterClassifier constant(const Kinds& p, const Kinds& prior = {0.2, 0.2, 0.2, 0.2, 0.1, 0.1}) {
  Kinds scores{};
  for (std::size_t k = 0; k < kClusterKinds; ++k) scores[k] = std::log(p[k]);
  return ClusterClassifier(constantTrees(scores), {}, prior, {}, {});
}

float anyFloat(Rng& rng) {
  return static_cast<float>(rng.normal() * std::pow(10, rng.uniform(-30, 3)));
}

/// Twelve random trees of 7 nodes; maps for all kinds but the last.
ClusterClassifier example() {
  Rng rng(RngKey{5, 0, 0, 11});
  BoostedTrees trees;
  for (double& b : trees.base) b = rng.normal();
  for (int t = 0; t < 12; ++t) {
    const auto root = static_cast<std::int32_t>(trees.nodes.size());
    trees.roots.push_back(root);
    for (std::int32_t i = 0; i < 3; ++i)
      trees.nodes.push_back({static_cast<std::int16_t>(rng.below(kFeatures)), anyFloat(rng),
                             root + 2 * i + 1, root + 2 * i + 2});
    for (int i = 0; i < 4; ++i) trees.nodes.push_back({-1, anyFloat(rng), 0, 0});
  }
  trees.nodes[0].threshold =
      7.038531e-26F;  // a text of so many digits is not enough by way of double
  std::array<Calibration, kClusterKinds> maps;
  for (std::size_t k = 0; k < 4; ++k) maps[k].knots = {{0.1 / 3, 0.002}, {0.5, 1.0 / 3}, {1, 1}};
  EvidenceMemory memory;
  memory.kept = 0.7, memory.bearing = 0.1;
  return ClusterClassifier(trees, maps, {0.1, 0.1, 0.3, 0.3, 0.1, 0.1}, memory,
                           {"1 \"a\"", "2025-01-01", "CC0", {"log a", "log\nb"}, true});
}

Descriptor anyDescriptor(Rng& rng) {
  Descriptor d;
  for (float& v : d) v = anyFloat(rng);
  return d;
}

/// The example's text with one part replaced.
std::string damaged(const std::string& part, const std::string& by) {
  std::string text = example().write();
  const std::size_t at = text.find(part);
  if (at == std::string::npos) throw std::logic_error("not in the text: " + part);
  return text.replace(at, part.size(), by);
}

std::string refusal(const std::string& text) {
  try {
    ClusterClassifier::parse(text, "model.json");
  } catch (const DataError& e) {
    EXPECT_EQ(e.code(), ExitCode::kBadInput);
    return e.what();
  }
  return "accepted";
}

/// A text with that tree for the first one.
std::string withTree(const std::string& nodes) {
  std::string text = example().write();
  const std::size_t begin = text.find("{\"node\":");
  return text.replace(begin, text.find('\n', begin) - begin, "{\"node\":" + nodes + "},");
}

#define EXPECT_REFUSED(text, words) \
  EXPECT_NE(refusal(text).find(words), std::string::npos) << refusal(text)

TEST(BoostedTrees, AddTheLeavesThatTheDescriptorFallsInto) {
  BoostedTrees trees = constantTrees({1, 2, 3, 4, 5, 6});
  trees.roots[1] = 6;
  trees.nodes.insert(trees.nodes.end(),
                     {Node{2, 0.5F, 7, 8}, Node{-1, 10.0F, 0, 0}, Node{-1, 20.0F, 0, 0}});
  Descriptor d{};
  double scores[kClusterKinds];
  d[2] = 0.5F;  // up to the threshold: left
  trees.scores(d, scores);
  EXPECT_EQ(scores[1], 12);
  EXPECT_EQ(scores[4], 5);
  d[2] = std::nextafter(0.5F, 1.0F);
  trees.scores(d, scores);
  EXPECT_EQ(scores[1], 22);
  d[2] = std::numeric_limits<float>::quiet_NaN();
  trees.scores(d, scores);
  EXPECT_EQ(scores[1], 22);
}

TEST(Calibration, IsLinearBetweenKnotsAndConstantOutside) {
  const Calibration map{{{0.2, 0.1}, {0.4, 0.5}, {0.6, 0.5}}};
  EXPECT_EQ(map(0), 0.1);
  EXPECT_EQ(map(0.2), 0.1);
  EXPECT_NEAR(map(0.25), 0.2, 1e-15);
  EXPECT_EQ(map(0.5), 0.5);
  EXPECT_EQ(map(1), 0.5);
  EXPECT_EQ(Calibration{}(0.37), 0.37);
}

TEST(ClusterClassifier, ProbabilitiesWithoutMapsAreTheSoftmax) {
  const Kinds p = constant({0.1, 0.2, 0.3, 0.2, 0.05, 0.15}).probabilities({});
  EXPECT_NEAR(p[0], 0.1, 1e-15);
  EXPECT_NEAR(p[2], 0.3, 1e-15);
}

TEST(ClusterClassifier, MixesNinePartsOfTheMappedProbabilityWithOneOfTheRaw) {
  std::array<Calibration, kClusterKinds> maps;
  maps[0].knots = {{0, 0.6}, {1, 0.6}};
  const Kinds p = ClusterClassifier(constantTrees({}), maps, {0.2, 0.2, 0.2, 0.2, 0.1, 0.1}, {}, {})
                      .probabilities({});
  const double first = 0.9 * 0.6 + 0.1 / 6, others = 1.0 / 6;
  EXPECT_NEAR(p[0], first / (first + 5 * others), 1e-15);
  EXPECT_NEAR(std::accumulate(p.begin(), p.end(), 0.0), 1, 1e-15);
}

TEST(ClusterClassifier, EvidenceIsTheLogRatioToAThingOrAPhantomWithoutThePrior) {
  const auto e = constant({0.3, 0.1, 0.1, 0.2, 0.1, 0.2}, {0.1, 0.1, 0.1, 0.5, 0.1, 0.1})
                     .evidence(Descriptor{});
  // 20 % of "mixed" weakens it by as much.
  const double none = (0.2 + 0.1) / (0.5 + 0.1);
  EXPECT_NEAR(e[0], 0.8 * std::log((0.3 / 0.1) / none), 1e-14);
  EXPECT_NEAR(e[1], 0.8 * std::log((0.1 / 0.1) / none), 1e-14);
  EXPECT_EQ(e[static_cast<std::size_t>(ClusterKind::kThing)], 0);
  EXPECT_NEAR(e[static_cast<std::size_t>(ClusterKind::kPhantom)],
              0.8 * std::log((0.1 / 0.1) / none), 1e-14);
}

TEST(ClusterClassifier, EvidenceOfAPhantomIsTheLogRatioToAnythingElse) {
  const auto classifier =
      constant({0.3, 0.1, 0.1, 0.2, 0.1, 0.2}, {0.1, 0.1, 0.1, 0.54, 0.06, 0.1});
  const auto p = classifier.probabilities(Descriptor{});
  EXPECT_NEAR(classifier.phantomEvidence(p), 0.8 * std::log(0.1 / 0.9 / (0.06 / 0.94)), 1e-14);
}

TEST(ClusterClassifier, EvidenceIsLimited) {
  const auto e = constant({1, 1e-300, 1e-9, 1e-6, 1e-9, 1e-300}).evidence(Descriptor{});
  EXPECT_NEAR(e[0], 6, 1e-12);
  EXPECT_NEAR(e[1], -6, 1e-12);
}

TEST(ClusterClassifier, ReadsWhatItWroteBitForBit) {
  const test::TemporaryFolder folder;
  const ClusterClassifier before = example();
  const std::string file = folder / "model.json";
  std::ofstream(file, std::ios::binary) << before.write();
  const ClusterClassifier after = ClusterClassifier::read(file);
  EXPECT_EQ(after.write(), before.write());
  Rng rng(RngKey{6, 0, 0, 11});
  for (int i = 0; i < 200; ++i) {
    const Descriptor d = anyDescriptor(rng);
    EXPECT_EQ(after.probabilities(d), before.probabilities(d));
  }
  EXPECT_EQ(after.trees().nodes[0].threshold, 7.038531e-26F);
  EXPECT_EQ(after.prior(), before.prior());
  EXPECT_EQ(after.memory().kept, 0.7);
  EXPECT_EQ(after.provenance().version, "1 \"a\"");
  EXPECT_EQ(after.provenance().data, before.provenance().data);
  EXPECT_TRUE(after.provenance().simulated_only);
}

TEST(ClusterClassifier, ModelsOfRecordingsBelieveFewReturnsLessThatTheyAreAPedestrian) {
  const ClusterClassifier simulated = example();
  EXPECT_EQ(simulated.memory().pedestrianWeight(20), 1);
  Provenance recorded = simulated.provenance();
  recorded.simulated_only = false;
  const ClusterClassifier model(simulated.trees(), simulated.calibrations(), simulated.prior(),
                                simulated.memory(), recorded);
  EXPECT_NEAR(model.memory().pedestrianWeight(20), 1.2 * 20 / 45, 1e-12);
  EXPECT_EQ(model.memory().pedestrianWeight(125), 1);
}

TEST(ClusterClassifier, WritesOneTreeALine) {
  const std::string text = example().write();
  std::size_t lines = 0;
  for (std::size_t at = text.find("\n{\"node\":"); at != std::string::npos; ++lines)
    at = text.find("\n{\"node\":", at + 1);
  EXPECT_EQ(lines, 12u);
}

TEST(ClusterClassifier, AMissingFileHasAnExitCodeOfItsOwn) {
  const test::TemporaryFolder folder;
  try {
    ClusterClassifier::read(folder / "none.json");
    FAIL();
  } catch (const DataError& e) {
    EXPECT_EQ(e.code(), ExitCode::kNoInput);
    EXPECT_NE(std::string(e.what()).find("none.json"), std::string::npos);
  }
  EXPECT_THROW(ClusterClassifier::read(folder.path()), DataError);  // a folder
}

TEST(ClusterClassifier, RefusesWhatIsNotItsFormat) {
  EXPECT_REFUSED("", "model.json: not a perception lidar classifier");
  EXPECT_REFUSED("[1]", "model.json: outermost value: found an array of 1, expected an object");
  EXPECT_REFUSED("{}", "expected a member 'format'");
  EXPECT_REFUSED(example().write().substr(0, 900), "not a perception lidar classifier");
  EXPECT_REFUSED(damaged("perception lidar", "other"), "format: found \"other classifier\"");
  EXPECT_REFUSED(damaged("\"version\":1,", "\"version\":2,"), "version: found 2, expected 1");
  EXPECT_REFUSED(damaged("\"version\":1,", "\"version\":1,\"more\":0,"), "no member \"more\"");
  EXPECT_REFUSED(damaged("\"length\"", "\"depth\""), "features[0]: found \"depth\"");
  EXPECT_REFUSED(damaged("\"length\",", ""), "features: found an array of 51");
  EXPECT_REFUSED(damaged("\"cyclist\",", "\"bicycle\","), "kinds[1]: found \"bicycle\"");
}

TEST(ClusterClassifier, RefusesDamagedParameters) {
  EXPECT_REFUSED(damaged("[0.1,0.1,0.3", "[0.2,0.1,0.3"),
                 "prior: found an array of 6, expected a "
                 "sum of 1, not 1.1");
  EXPECT_REFUSED(damaged("[0.1,0.1,0.3", "[0,0.2,0.3"), "prior[0]: found 0");
  EXPECT_REFUSED(damaged("[0.1,0.1,0.3", "[-0.1,0.3,0.3"), "prior[0]: found -0.1");
  EXPECT_REFUSED(damaged("[0.1,0.1,0.3", "[null,0.1,0.3"), "prior[0]: found null");
  EXPECT_REFUSED(damaged("\"kept\":0.7", "\"kept\":1.7"), "memory.kept: found 1.7");
  EXPECT_REFUSED(damaged("\"time\":1", "\"tim\":1"),
                 "memory: found an object of 6 members, "
                 "expected no member \"tim\"");
  EXPECT_REFUSED(damaged("true", "1"), "provenance.simulated_only: found 1");
  EXPECT_REFUSED(damaged("\"log a\"", "7"), "provenance.data[0]: found 7, expected a text");
  EXPECT_REFUSED(damaged("[0.5,0.333", "[0.01,0.333"), "calibration.pedestrian[1].raw: found 0.01");
  EXPECT_REFUSED(damaged("[0.5,0.333", "[0.5,0.001,0.3"),
                 "calibration.pedestrian[1]: found an arr");
  EXPECT_REFUSED(damaged(",0.002]", ",0.4]"), "calibration.pedestrian[1].calibrated: found 0.333");
  EXPECT_REFUSED(damaged("[1,1]", "[1,1.5]"), "calibration.pedestrian[2].calibrated: found 1.5");
  EXPECT_REFUSED(damaged("\"mixed\":", "\"more\":"), "no member \"more\"");
  EXPECT_REFUSED(damaged("\"base\":[", "\"base\":[1e9,"), "base: found an array of 7");
  EXPECT_REFUSED(damaged("\"base\":[", "\"base\":[1e999,"), "1e999");
}

TEST(ClusterClassifier, RefusesDamagedTrees) {
  EXPECT_EQ(refusal(withTree("[[0,0.5,1,2],[1],[2]]")), "accepted");
  EXPECT_REFUSED(withTree("[]"), "trees[0].node: found an array of 0");
  EXPECT_REFUSED(withTree("3"), "trees[0].node: found 3");
  EXPECT_REFUSED(withTree("[[]]"), "trees[0].node[0]: found an array of 0");
  EXPECT_REFUSED(withTree("[[1,2]]"), "trees[0].node[0]: found an array of 2, expected [value] or");
  EXPECT_REFUSED(withTree("[[0,0.5,0,1],[1],[2]]"),
                 "trees[0].node[0].left: found 0, expected a "
                 "whole number from 1 to 2");
  EXPECT_REFUSED(withTree("[[0,0.5,1,3],[1],[2]]"), "trees[0].node[0].right: found 3");
  EXPECT_REFUSED(withTree("[[0,0.5,-1,2],[1],[2]]"), "trees[0].node[0].left: found -1");
  EXPECT_REFUSED(withTree("[[0,0.5,1,18446744073709551615],[1],[2]]"), "node[0].right: found 1844");
  EXPECT_REFUSED(withTree("[[0,0.5,1.5,2],[1],[2]]"), "trees[0].node[0].left: found 1.5");
  EXPECT_REFUSED(withTree("[[0,0.5,1,2],[1],[1,0.5,1,2]]"),
                 "trees[0].node[2]: found an array of 4");
  EXPECT_REFUSED(withTree("[[52,0.5,1,2],[1],[2]]"), "trees[0].node[0].feature: found 52");
  EXPECT_REFUSED(withTree("[[-1,0.5,1,2],[1],[2]]"), "trees[0].node[0].feature: found -1");
  EXPECT_REFUSED(withTree("[[0,1e39,1,2],[1],[2]]"), "trees[0].node[0].threshold: found 1e+39");
  EXPECT_REFUSED(withTree("[[0,0.5,1,2],[\"1\"],[2]]"), "trees[0].node[1].value: found \"1\"");
  EXPECT_REFUSED(damaged("\"trees\":[\n", "\"trees\":[\n{\"node\":[[0]]},"),
                 "a multiple of 6 trees");
  EXPECT_REFUSED(damaged("{\"node\":", "{\"leaf\":"), "trees[0]: found an object of 1 members");
}

TEST(ClusterClassifier, RefusesWhatWouldTakeTooMuchMemory) {
  EXPECT_REFUSED(std::string(1000000, '['), "arrays and objects in each other");
  std::string many = "[0";
  for (int i = 0; i < 2100000; ++i) many += ",0";
  EXPECT_REFUSED(many + "]", "more than 2000000 values");
  std::string nodes = "[[0]";
  for (int i = 0; i < 100000; ++i) nodes += ",[0]";
  EXPECT_REFUSED(withTree(nodes + "]"), "trees[0].node: found an array of 100001");
  nodes.resize(nodes.size() - 4);
  EXPECT_REFUSED(withTree(nodes + "]"), "expected at most 100000 nodes in all trees");
  EXPECT_THROW(ClusterClassifier::read("/dev/zero"), DataError);
}

}  // namespace
}  // namespace perception
