#include "libperception/evaluation/metrics/Identities.h"

#include <gtest/gtest.h>

#include <cmath>

namespace perception {
namespace {

/// `count` instants at which truth 1 stands at (0, 0); the output with the id that `id_at` gives is
/// `off` [m] away, none for an id of 0.
template <class IdAt>
std::vector<IdentityView> oneObject(int count, double off, const IdAt& id_at) {
  std::vector<IdentityView> instants;
  for (int i = 0; i < count; ++i) {
    const std::uint64_t id = id_at(i);
    const auto ids = id == 0 ? std::vector<std::uint64_t>{} : std::vector<std::uint64_t>{id};
    const std::vector<Vector2> at(ids.size(), Vector2(off, 0));
    instants.push_back(identityView({1}, {Vector2::Zero()}, ids, at, 2));
  }
  return instants;
}

TEST(Identities, APerfectTrackHasAllOnes) {
  const auto f = identityFigures(oneObject(10, 0, [](int) { return 7; }));
  EXPECT_NEAR(*f.hota, 1, 1e-12);
  EXPECT_NEAR(*f.detection, 1, 1e-12);
  EXPECT_NEAR(*f.association, 1, 1e-12);
  EXPECT_NEAR(*f.idf1, 1, 1e-12);
}

TEST(Identities, ASwitchInTheMiddleHalvesTheAssociation) {
  // Every pair is together at 5 of the 10 instants at which one of the two is there.
  const auto f = identityFigures(oneObject(10, 0, [](int i) { return i < 5 ? 7 : 8; }));
  EXPECT_NEAR(*f.detection, 1, 1e-12);
  EXPECT_NEAR(*f.association, 0.5, 1e-12);
  EXPECT_NEAR(*f.hota, std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(*f.idf1, 2 * 5 / 20.0, 1e-12);
}

TEST(Identities, WhatIsMissedHalfOfTheTimeCountsInBothParts) {
  const auto f = identityFigures(oneObject(10, 0, [](int i) { return i % 2 == 0 ? 7 : 0; }));
  EXPECT_NEAR(*f.detection, 0.5, 1e-12);
  EXPECT_NEAR(*f.association, 0.5, 1e-12);
  EXPECT_NEAR(*f.hota, 0.5, 1e-12);
  EXPECT_NEAR(*f.idf1, 2 * 5 / 15.0, 1e-12);
}

TEST(Identities, ADistanceCostsTheLevelsAboveIts) {
  // Half a meter of two: a similarity of .75, 15 of the 19 levels.
  const auto f = identityFigures(oneObject(4, 0.5, [](int) { return 7; }));
  EXPECT_NEAR(*f.hota, 15 / 19.0, 1e-12);
  EXPECT_NEAR(*f.idf1, 1, 1e-12);
}

TEST(Identities, APairIsKeptThoughAnotherIsNearerForAnInstant) {
  // Two objects a meter apart with their tracks; at one instant the tracks stand nearer to the
  // other one. The pairs of the whole time win.
  std::vector<IdentityView> instants;
  const std::vector<Vector2> truth = {{0, 0}, {1, 0}};
  for (int i = 0; i < 9; ++i) instants.push_back(identityView({1, 2}, truth, {7, 8}, truth, 2));
  instants.push_back(identityView({1, 2}, truth, {7, 8}, {{0.6, 0}, {0.4, 0}}, 2));
  const auto f = identityFigures(instants);
  EXPECT_NEAR(*f.association, 1, 0.12);
  EXPECT_NEAR(*f.idf1, 1, 1e-12);
}

TEST(Identities, FalseOutputsAndTruthWithoutIdentity) {
  auto instants = oneObject(10, 0, [](int) { return 7; });
  for (auto& view : instants) view.estimates.push_back(9);  // near nothing
  EXPECT_NEAR(*identityFigures(instants).detection, 0.5, 1e-12);
  EXPECT_NEAR(*identityFigures(instants).idf1, 2 * 10 / 30.0, 1e-12);
  for (auto& view : instants) view.truth = {-1};  // another object every time
  EXPECT_NEAR(*identityFigures(instants).association, 0.1, 1e-12);
  EXPECT_FALSE(identityFigures(std::vector<IdentityView>{}).hota) << "no truth, no figure";
}

}  // namespace
}  // namespace perception
