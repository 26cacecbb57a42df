#include "libperception/calibration/clusters/ClusterStudy.h"

#include <gtest/gtest.h>

#include "libperception/core/Error.h"
#include "libperception/core/math/Random.h"

namespace perception {
namespace {

/// Twenty vehicles of any shape a log.
ClusterSamples vehicles(std::size_t logs) {
  ClusterSamples samples;
  Rng rng(RngKey{4, 0, 0, 11});
  for (std::size_t i = 0; i < 20 * logs; ++i) {
    ClusterSample s;
    s.log = i / 20, s.kind = ClusterKind::kVehicle;
    for (float& v : s.descriptor) v = static_cast<float>(1 + rng.uniform());
    samples.clusters.push_back(s);
  }
  return samples;
}

ClusterClassifier learnedFrom(const std::vector<std::string>& logs) {
  BoostedTrees trees;
  for (std::int32_t k = 0; k < static_cast<std::int32_t>(kClusterKinds); ++k) {
    trees.roots.push_back(k);
    trees.nodes.push_back({-1, 0.25F, 0, 0});
  }
  return ClusterClassifier(trees, {}, {0.2, 0.2, 0.2, 0.2, 0.1, 0.1}, {},
                           {"1", "2026-01-01", "CC0", logs, false});
}

TEST(KnownShapesStudy, AddsKnownShapesAndKeepsTheRestOfTheModel) {
  const ClusterClassifier model = learnedFrom({"a", "b", "c"});
  const StudyReport report =
      knownShapesStudy(vehicles(3), {{"a", false}, {"b", false}, {"c", false}}, model);
  ASSERT_EQ(report.files.size(), 1u);
  const ClusterClassifier now = ClusterClassifier::parse(report.files[0].second, "model.json");
  EXPECT_GT(now.known().of(static_cast<std::size_t>(ClusterKind::kVehicle)).within, 0);
  const ClusterClassifier without(now.trees(), now.calibrations(), now.prior(), now.memory(),
                                  now.provenance());
  EXPECT_EQ(without.write(), model.write());
}

TEST(KnownShapesStudy, WhatTheModelHasNotLearnedFromIsNotKnownForBeingThere) {
  const std::vector<TrainingLog> logs = {{"a", false}, {"b", false}, {"d", false}};
  try {
    knownShapesStudy(vehicles(3), logs, learnedFrom({"a", "b", "c"}));
    FAIL() << "accepted";
  } catch (const DataError& e) {
    EXPECT_STREQ(e.what(), "d: the model has not learned from this log, expected one of a, b, c");
  }
}

TEST(KnownShapesStudy, SimulatedLogsAreNoExamples) {
  const StudyReport report = knownShapesStudy(
      vehicles(3), {{"a", false}, {"b", false}, {"s", true}}, learnedFrom({"a", "b"}));
  EXPECT_EQ(report.files[0].second.find("known"), std::string::npos) << "two recordings";
}

}  // namespace
}  // namespace perception
