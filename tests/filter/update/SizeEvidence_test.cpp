#include "libperception/filter/update/SizeEvidence.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/config/Config.h"
#include "libperception/core/math/LogMath.h"

namespace perception {
namespace {

FilterModel shippedModel() {
  FilterModel model;
  Config config = Config::fromFile(PERCEPTION_SOURCE_DIR "/ini/classes.ini");
  model.classes = readClassTable(config);
  model.params.side_exponent = 1;
  model.params.height_exponent = 1;
  return model;
}

Track newborn(const FilterModel& model) {
  Track track;
  track.log_class.assign(static_cast<std::size_t>(model.classes.size()), 0);
  startSizes(model, track);
  return track;
}

Measurement box(double a, double b) {
  Measurement m;
  m.sides = PartialBox{};
  m.sides->yaw = 0.1;
  m.sides->length = a, m.sides->width = b;
  m.sides->length_complete = m.sides->width_complete = true;
  return m;
}

double odds(const FilterModel& model, const Track& track, const char* a, const char* b) {
  return track.log_class[static_cast<std::size_t>(model.classes.find(a))] -
         track.log_class[static_cast<std::size_t>(model.classes.find(b))];
}

TEST(SizeEvidence, ACarsBoxIsNoBus) {
  const FilterModel model = shippedModel();
  Track track = newborn(model);
  updateSizes(box(4.4, 1.8), 0.0, model, track);
  EXPECT_GT(odds(model, track, "car", "bus"), 2);
  EXPECT_GT(odds(model, track, "car", "pedestrian"), 2);
  Track coach = newborn(model);
  updateSizes(box(11.5, 2.5), 0.0, model, coach);
  EXPECT_GT(odds(model, coach, "bus", "car"), 2);
}

TEST(SizeEvidence, SidesFollowTheAxis) {
  const FilterModel model = shippedModel();
  Track along = newborn(model), across = newborn(model);
  updateSizes(box(4.4, 1.8), 0.0, model, along);
  updateSizes(box(1.8, 4.4), kPi / 2, model, across);
  EXPECT_NEAR(along.length.mean, across.length.mean, 1e-12);
  EXPECT_NEAR(odds(model, along, "car", "bus"), odds(model, across, "car", "bus"), 1e-12);
}

TEST(SizeEvidence, CountsASizeOnceHoweverOftenItIsSeen) {
  const FilterModel model = shippedModel();
  Track track = newborn(model);
  for (int i = 0; i < 20; ++i) updateSizes(box(4.4, 1.8), 0.0, model, track);
  const double after_twenty = odds(model, track, "car", "bus");
  for (int i = 0; i < 500; ++i) updateSizes(box(4.4, 1.8), 0.0, model, track);
  EXPECT_NEAR(odds(model, track, "car", "bus"), after_twenty, 0.1);
}

TEST(SizeEvidence, OrderDoesNotMatter) {
  const FilterModel model = shippedModel();
  Track one = newborn(model), other = newborn(model);
  for (const double length : {4.2, 4.6, 5.0}) updateSizes(box(length, 1.8), 0.0, model, one);
  for (const double length : {5.0, 4.2, 4.6}) updateSizes(box(length, 1.8), 0.0, model, other);
  EXPECT_NEAR(odds(model, one, "car", "bus"), odds(model, other, "car", "bus"), 1e-9);
}

TEST(SizeEvidence, WithoutAnAxisOrACompleteSideNothingIsSaid) {
  const FilterModel model = shippedModel();
  Track track = newborn(model);
  updateSizes(box(4.4, 1.8), {}, model, track);
  Measurement open = box(4.4, 1.8);
  open.sides->length_complete = open.sides->width_complete = false;
  updateSizes(open, 0.0, model, track);
  updateSizes(box(4.4, 1.8), kPi / 4, model, track);  // neither along nor across
  for (const double lp : track.log_class) EXPECT_EQ(lp, 0);
}

Measurement cluster(double height) {
  Measurement m;
  m.height = ScalarEstimate{height, 0.02};
  m.view = EvidenceView{0.1, 3, 100};
  return m;
}

TEST(SizeEvidence, ALowClusterMayBeAPartOfACar) {
  const FilterModel model = shippedModel();
  const auto seen = [&](const Measurement& m) {
    Track track = newborn(model);
    for (int i = 0; i < 10; ++i) updateSizes(m, 0.0, model, track);
    return track;
  };
  const Track fragment = seen(cluster(0.2)), whole = seen(cluster(1.5));
  EXPECT_GT(odds(model, fragment, "car", "static-other"), -2);
  EXPECT_LT(odds(model, fragment, "car", "static-other"), 0);
  EXPECT_GT(odds(model, whole, "car", "static-other"), 0);
  Measurement box = cluster(0.2);
  box.view.reset();  // not of clusters that are told by their shape: the box of a detector
  EXPECT_LT(odds(model, seen(box), "car", "static-other"), -5);
}

TEST(SizeEvidence, AThinClusterMayBeAPartOfACar) {
  const FilterModel model = shippedModel();
  const auto seen = [&](bool cluster) {
    Measurement face = box(2.7, 0.1);
    if (cluster) face.view = EvidenceView{0.1, 3, 100};
    Track track = newborn(model);
    for (int i = 0; i < 10; ++i) updateSizes(face, 0.0, model, track);
    return odds(model, track, "car", "static-other");
  };
  EXPECT_GT(seen(true), -3);
  EXPECT_LT(seen(true), 0);
  EXPECT_LT(seen(false), seen(true) - 2);
}

TEST(SizeEvidence, WhatMayBeAPartTellsCarsFromBusesAsAWholeDoes) {
  const FilterModel model = shippedModel();
  for (const double height : {0.2, 1.5, 3.0}) {
    Track part = newborn(model), whole = newborn(model);
    Measurement m = cluster(height);
    updateSizes(m, 0.0, model, part);
    m.view.reset();
    updateSizes(m, 0.0, model, whole);
    EXPECT_NEAR(odds(model, part, "car", "bus"), odds(model, whole, "car", "bus"), 1e-9);
  }
}

/// A cluster whose longer side alone is complete, across the axis 0.
Measurement across(double side) {
  Measurement m = cluster(1.7);
  m.height.reset();
  m.sides = box(side, 1.6).sides;
  m.sides->yaw = kPi / 2 - 0.1;
  m.sides->width_complete = false;
  return m;
}

TEST(SizeEvidence, ASideTooLongForAWidthIsALength) {
  const FilterModel model = shippedModel();
  const auto car = static_cast<std::size_t>(model.classes.find("car"));
  constexpr double kLikelyCar = 5;
  const auto seen = [&](Measurement m, bool told_by_shape) {
    if (!told_by_shape) m.view.reset();
    Track track = newborn(model);
    track.log_class[car] = kLikelyCar;
    for (int i = 0; i < 5; ++i) updateSizes(m, 0.0, model, track);
    track.log_class[car] -= kLikelyCar;  // what the sides have added remains
    return track;
  };
  const Track van = seen(across(3.8), true);
  EXPECT_GT(odds(model, van, "car", "bus"), 1);
  EXPECT_NEAR(van.width.mean, 3.8, 0.2) << "between shapes the heading is believed";
  EXPECT_LT(odds(model, seen(across(3.8), false), "car", "bus"), 0) << "a detector knows its axis";
  const Track rear = seen(across(1.8), true);
  EXPECT_NEAR(rear.fitting_width.mean, rear.width.mean, 1e-12) << "that is a width";
}

TEST(SizeEvidence, WhatIsLongerThanAnyCarIsMoreLikelyABus) {
  const FilterModel model = shippedModel();
  const auto seen = [&](double length, double vehicle) {
    Measurement m = cluster(1.7);
    m.height.reset();
    m.sides = box(length, 1.6).sides;
    m.sides->length_complete = m.sides->width_complete = false;
    for (const ObjectClass& c : model.classes.classes)
      m.log_class.push_back(c.shape == ObjectShape::kVehicle ? vehicle : -5);
    Track track = newborn(model);
    for (int i = 0; i < 5; ++i) updateSizes(m, 0.0, model, track);
    return odds(model, track, "bus", "car");
  };
  EXPECT_NEAR(seen(9.8, 3), std::log(1 / 0.05), 1e-9) << "it may be two cars";
  EXPECT_NEAR(seen(6.6, 3), 0, 1e-9);
  EXPECT_NEAR(seen(9.8, 1), 0, 1e-9) << "perhaps a hedge";
}

TEST(SizeEvidence, WhatIsLongerThanAnyCarAndHigherThanMostIsABus) {
  FilterModel model = shippedModel();
  model.params.side_exponent = 0.5;
  const auto seen = [&](double length, double height) {
    Measurement m = cluster(height);
    m.sides = box(length, 1.6).sides;
    m.sides->length_complete = m.sides->width_complete = false;
    m.height->variance = 1.5 * 1.5;  // its top is outside the view
    for (const ObjectClass& c : model.classes.classes)
      m.log_class.push_back(c.shape == ObjectShape::kVehicle ? 3 : -5);
    Track track = newborn(model);
    for (int i = 0; i < 9; ++i) updateSizes(m, 0.0, model, track);
    std::vector<double> vehicles = {
        track.log_class[static_cast<std::size_t>(model.classes.find("bus"))],
        track.log_class[static_cast<std::size_t>(model.classes.find("car"))]};
    return std::make_pair(vehicles[0] - vehicles[1], logSumExp(vehicles));
  };
  const auto high = seen(9.8, 2.3), low = seen(9.8, 1.9), shorter = seen(6.6, 2.3),
             touching = seen(7.6, 2.3), touching_low = seen(7.6, 1.9);
  EXPECT_GT(high.first, low.first + 4.5) << "hardly two cars";
  EXPECT_LT(shorter.first, high.first - 6) << "a van";
  EXPECT_LT(touching.first, touching_low.first + 2) << "a van that touches something";
  EXPECT_NEAR(high.second, low.second, 0.8) << "as likely a vehicle";
}

TEST(SizeEvidence, NoSizeIsAProof) {
  const FilterModel model = shippedModel();
  Track track = newborn(model);
  updateSizes(box(80, 40), 0.0, model, track);
  const double worst = 2 * std::log(15 / 0.05);  // two sides, each at worst of any size
  for (const double lp : track.log_class) EXPECT_GT(lp, -worst - 2);
}

}  // namespace
}  // namespace perception
