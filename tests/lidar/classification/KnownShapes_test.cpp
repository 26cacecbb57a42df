#include "libperception/lidar/classification/KnownShapes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/core/Error.h"
#include "libperception/lidar/classification/JsonItem.h"
#include "libperception/lidar/classification/JudgedClusters.h"
#include "tests/support/ClusterScenes.h"

namespace perception {
namespace {

constexpr auto kVehicle = static_cast<std::size_t>(ClusterKind::kVehicle);

/// Three examples of vehicles of this length [m], each feature with a deviation of 0.5.
KnownShapes vehiclesOf(double length) {
  KnownShapes known;
  KnownShapes::OfKind& vehicle = known.of(kVehicle);
  vehicle.within = 0.4;
  vehicle.scale.fill(0.5f);
  KnownShapes::Geometry example{};
  example.fill(std::log(0.5f));
  example[0] = static_cast<float>(std::log(length));
  vehicle.examples.assign(3, example);
  return known;
}

/// A cluster of that length whose other features are those of the examples.
Descriptor longAs(double length) {
  Descriptor d{};
  for (const Feature f : KnownShapes::kFeaturesUsed) d[static_cast<std::size_t>(f)] = 0.5f;
  d[static_cast<std::size_t>(Feature::kLength)] = static_cast<float>(length);
  return d;
}

/// [m] The length whose geometry is that far from 4 m.
double lengthAt(double distance) { return 4 * std::exp(distance * 0.5 * std::sqrt(6.0)); }

TEST(KnownShapes, TheDistanceIsTheRootMeanSquareOverTheFeaturesInDeviations) {
  const KnownShapes known = vehiclesOf(4);
  const auto distance = [&](double length) {
    return known.of(kVehicle).distance(KnownShapes::geometryOf(longAs(length)));
  };
  EXPECT_NEAR(distance(4), 0, 1e-6);
  EXPECT_NEAR(distance(4 * std::exp(0.5)), std::sqrt(1.0 / 6), 1e-5)
      << "one deviation in one of six";
}

TEST(KnownShapes, TheDistanceIsTheMeanOfTheThreeNearestExamples) {
  KnownShapes known = vehiclesOf(4);
  auto& examples = known.of(kVehicle).examples;
  examples[1][0] += 0.5f, examples[2][0] += 1.0f;
  examples.push_back(examples[0]);
  examples.back()[0] += 9.0f;
  EXPECT_NEAR(known.of(kVehicle).distance(KnownShapes::geometryOf(longAs(4))), std::sqrt(1.0 / 6),
              1e-5)
      << "of 0, 1 and 2 deviations";
  examples.resize(2);
  EXPECT_TRUE(std::isinf(known.of(kVehicle).distance(KnownShapes::geometryOf(longAs(4)))));
}

TEST(KnownShapes, WhatIsNearCountsInFullAndWhatIsFarNotAtAll) {
  const KnownShapes known = vehiclesOf(4);  // within 0.4
  const auto weight = [&](double distance) {
    return known.weight(ClusterKind::kVehicle, longAs(lengthAt(distance)));
  };
  EXPECT_EQ(weight(0), 1);
  EXPECT_EQ(weight(0.39), 1);
  EXPECT_NEAR(weight(0.6), 0.5, 1e-4);
  EXPECT_EQ(weight(0.81), 0);
}

TEST(KnownShapes, AKindOfWhichNothingIsStoredCountsInFull) {
  EXPECT_EQ(vehiclesOf(4).weight(ClusterKind::kPedestrian, longAs(40)), 1);
  EXPECT_EQ(KnownShapes().weight(ClusterKind::kVehicle, longAs(40)), 1);
}

TEST(KnownShapes, OnlyWhatSpeaksForARoadUserIsWeighed) {
  std::array<double, kShapes> evidence{};
  evidence.fill(2);
  const auto weights = [&] { return vehiclesOf(4).weights(longAs(40), evidence); };
  EXPECT_EQ(weights(), (std::array<double, kRoadUsers>{1, 1, 0}));
  evidence[kVehicle] = -1;
  EXPECT_EQ(weights(), (std::array<double, kRoadUsers>{1, 1, 1})) << "what speaks against it stays";
}

TEST(KnownShapes, NoiseOfThinThingsSaysNothing) {
  Descriptor thin = longAs(4), thinner = thin;
  thin[static_cast<std::size_t>(Feature::kEdgeDistance)] = 0.003f;
  thinner[static_cast<std::size_t>(Feature::kEdgeDistance)] = 0.0001f;
  EXPECT_EQ(KnownShapes::geometryOf(thin), KnownShapes::geometryOf(thinner));
}

KnownShapes parsed(const std::string& text) {
  const std::string name = "model.json";
  const auto json = nlohmann::json::parse(text);
  return KnownShapes::read(JsonItem(json, name));
}

TEST(KnownShapes, ReadsWhatItWrote) {
  KnownShapes before = vehiclesOf(4.321);
  before.of(kVehicle).within = 0.1 + 0.2;
  before.of(kVehicle).examples[1][3] = -2.718f;
  const KnownShapes after = parsed(before.text());
  EXPECT_EQ(after.text(), before.text());
  EXPECT_EQ(after.of(kVehicle).within, before.of(kVehicle).within);
  EXPECT_EQ(after.of(kVehicle).scale, before.of(kVehicle).scale);
  EXPECT_EQ(after.of(kVehicle).examples, before.of(kVehicle).examples);
  EXPECT_EQ(after.of(0).within, 0) << "pedestrians: not stored";
  EXPECT_EQ(KnownShapes().text(), "");
}

TEST(KnownShapes, RefusesWhatCannotBe) {
  const std::string good = vehiclesOf(4).text();
  const auto refusal = [&](const std::string& part, const std::string& by) -> std::string {
    std::string text = good;
    text.replace(text.find(part), part.size(), by);
    try {
      parsed(text);
    } catch (const DataError& e) {
      return e.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal("0.4", "0"),
            "model.json: vehicle.within: found 0, expected a number from 1e-06 to 100");
  EXPECT_EQ(refusal("[0.5,", "[0,"),
            "model.json: vehicle.scale[0]: found 0, expected a number from 1e-06 to 100");
  EXPECT_EQ(refusal("[0.5,", "["),
            "model.json: vehicle.scale: found an array of 5, expected an array of 6");
  EXPECT_EQ(refusal("vehicle", "tree"),
            "model.json: outermost value: found an object of 1 members, expected no member "
            "\"tree\"");
}

/// Calls everything a vehicle.
ClusterClassifier vehiclesAlone(const KnownShapes& known) {
  BoostedTrees trees;
  trees.base = {-6, -6, 4, 0, -6, -6};
  for (std::int32_t k = 0; k < static_cast<std::int32_t>(kClusterKinds); ++k) {
    trees.roots.push_back(k);
    trees.nodes.push_back({-1, 0.0f, 0, 0});
  }
  return ClusterClassifier(trees, {}, {0.2, 0.2, 0.2, 0.2, 0.1, 0.1}, {}, {}, known);
}

TEST(KnownShapes, WhatIsUnlikeAllThatTheModelHasLearnedFromIsNoSureVehicle) {
  test::SolidScene scene;
  scene.boxes = {{{12.9, 0}, kPi / 2, 4.4, 1.8, 0.25, 2}};  // a van seen from the side
  const SensorFrame frame = test::castScan(scene, test::narrowLidar());
  const LidarDetections found = test::plainFrontEnd().detect(frame);
  const auto evidence = [&](const KnownShapes& known) {
    const auto judged = judgedClusters(found, std::get<LidarCloud>(frame.data),
                                       DirectionCells(found.points), vehiclesAlone(known));
    EXPECT_EQ(judged.clusters.size(), 1u);
    return judged.clusters.at(0).evidence[kVehicle];
  };
  const auto knowing = [](double length) {
    KnownShapes known = vehiclesOf(length);
    known.of(kVehicle).scale.fill(100);  // all but the length is alike
    known.of(kVehicle).scale[0] = 0.1f;
    return known;
  };
  const double before = evidence({});
  EXPECT_GT(before, 2);
  EXPECT_NEAR(evidence(knowing(4.4)), before, 1e-9);
  EXPECT_EQ(evidence(knowing(1.5)), 0);
}

TEST(KnownShapes, AModelKeepsThem) {
  const ClusterClassifier before = vehiclesAlone(vehiclesOf(4));
  const ClusterClassifier after = ClusterClassifier::parse(before.write(), "model.json");
  EXPECT_EQ(after.known().text(), vehiclesOf(4).text());
  EXPECT_EQ(after.write(), before.write());
  EXPECT_EQ(vehiclesAlone({}).write().find("known"), std::string::npos) << "nothing is known";
}

}  // namespace
}  // namespace perception
