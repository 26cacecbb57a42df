#include "libperception/scene/SceneFromPosterior.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <set>

#include "tests/scene/SceneFixture.h"

namespace perception {
namespace {

/// One car of 4 by 2 m whose place is known to `sigma` [m] along each axis.
Hypothesis oneCar(double sigma) {
  Track track;
  track.id = 1;
  track.existence = 0.99;
  track.stamp = track.birth = test::kFirstStamp;
  track.log_class = {-9.2, -1e-4};
  track.bank.resize(2);
  for (ClassFilter& f : track.bank) {
    f.x << 10, 3, 0, 0;
    f.P = Vector4(sigma * sigma, sigma * sigma, 0.1, 0.1).asDiagonal();
    f.extent = {4, 2, 0.01, 0.01};
  }
  return Hypothesis(TrackTable{std::make_shared<const Track>(track)});
}

std::size_t putOut(double sigma, double place_within, double place_sigma = 0) {
  FilterModel model;
  model.classes = test::pedestrianAndCar();
  SceneParams params;
  params.place_within = place_within;
  params.place_sigma = place_sigma;
  EgoState ego;
  ego.stamp = test::kFirstStamp;
  return SceneFromPosterior(model, params).make(oneCar(sigma), ego, 0).objects.size();
}

TEST(Scene, LeavesOutObjectsWhosePlaceIsTooUncertainForTheirSize) {
  // sqrt(4 * 2) = 2.83 m, half of it 1.41 m; deviations of 1 m in x and y are 1.41 m together.
  EXPECT_EQ(putOut(0.99, 0.5), 1U);
  EXPECT_EQ(putOut(1.01, 0.5), 0U);
}

TEST(Scene, WhatWasSeenOnceAndNotAgainWhereItShouldBeIsLessSureOfItsClass) {
  FilterModel model;
  model.classes = test::pedestrianAndCar();
  model.classes.classes[0].prior = 0.9, model.classes.classes[1].prior = 0.1;
  EgoState ego;
  ego.stamp = test::kFirstStamp;
  const auto car = [&](int hits, double missed) {
    Track track = *oneCar(0.1).tracks[0];
    track.log_class = {std::log(0.03), std::log(0.97)};
    track.hits[0] = hits, track.missed = missed;
    track.bank[0].extent = {0.5, 0.5, 0.01, 0.01};
    const Hypothesis h(TrackTable{std::make_shared<const Track>(track)});
    return SceneFromPosterior(model, {}).make(h, ego, 0).objects.at(0);
  };
  EXPECT_TRUE(car(1, 0).classified);
  EXPECT_NEAR(car(1, 0).class_probability[1], 0.97, 1e-9);
  EXPECT_FALSE(car(1, 0.9).classified);
  // Two of three looks count: between the prior and what was said.
  const double odds = std::pow(97 / 3.0, 2 / 3.0) * std::pow(1 / 9.0, 1 / 3.0);
  EXPECT_NEAR(car(1, 1).class_probability[1], odds / (1 + odds), 1e-9);
  EXPECT_EQ(car(1, 1).class_id, 1) << "it stays the likeliest class";
  EXPECT_EQ(car(1, 6).class_id, 0);
  EXPECT_EQ(car(1, 6).length, car(1, 0).length) << "it is not shorter for that";
  EXPECT_GT(car(30, 1).class_probability[1], 0.96) << "what was seen for long stays what it is";
}

TEST(Scene, ALateOneShowsWhatHasEndedSince) {
  FilterModel model;
  model.classes = test::pedestrianAndCar();
  model.history = 2;
  Hypothesis now;
  now.ended = {{oneCar(0.1).tracks[0], test::kFirstStamp + 0.1}};
  const auto objects = [&](double t) {
    EgoState ego;
    ego.stamp = test::kFirstStamp + t;
    return SceneFromPosterior(model, {}).make(now, ego, 0).objects.size();
  };
  EXPECT_EQ(objects(0), 1U);
  EXPECT_EQ(objects(0.1), 0U) << "its end";
}

TEST(Scene, LeavesOutObjectsThatAreNowhere) {
  const double sigma = 5 / std::sqrt(2.0);
  EXPECT_EQ(putOut(0.99 * sigma, 0, 5), 1U);
  EXPECT_EQ(putOut(1.01 * sigma, 0, 5), 0U);
  EXPECT_EQ(SceneParams{}.place_sigma, 5);
}

TEST(Scene, PutsOutEveryPlaceIfTold) { EXPECT_EQ(putOut(20, 0), 1U); }

TEST(Scene, GivesTheCovarianceOfPlaceAndVelocity) {
  FilterModel model;
  model.classes = test::pedestrianAndCar();
  for (ObjectClass& c : model.classes.classes) c.motion = findMotionModel("constant-velocity");
  EgoState ego;
  ego.stamp = test::kFirstStamp;
  const SceneObject o = SceneFromPosterior(model, {}).make(oneCar(0.5), ego, 0).objects.at(0);
  const Matrix4 wanted = Vector4(0.25, 0.25, 0.1, 0.1).asDiagonal();
  EXPECT_LT((o.covariance - wanted).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_EQ(o.covariance, o.covariance.transpose());
  EXPECT_EQ(o.sd_x, std::sqrt(o.covariance(0, 0)));
}

/// p_front of a car that has traveled `way` [m] along its heading and was seen by these sensors.
double frontAfter(double way, std::initializer_list<Modality> seen_by) {
  FilterModel model;
  model.classes = test::pedestrianAndCar();
  EgoState ego;
  ego.stamp = test::kFirstStamp;
  for (ObjectClass& c : model.classes.classes) c.motion = findMotionModel("wheeled");
  Track track = *oneCar(0.1).tracks[0];
  for (ClassFilter& f : track.bank) f.oriented = true, f.heading.traveled = way;
  for (const Modality m : seen_by) track.last_hit[modalityIndex(m)] = test::kFirstStamp;
  const Hypothesis one(TrackTable{std::make_shared<const Track>(track)});
  return SceneFromPosterior(model, {}).make(one, ego, 0).objects.at(0).p_front;
}

TEST(Scene, AShortWayInImagesAloneDoesNotTellTheFront) {
  EXPECT_GT(frontAfter(5, {Modality::kLidar}), 0.95);
  EXPECT_GT(frontAfter(5, {Modality::kCamera, Modality::kLidar}), 0.95);
  EXPECT_GT(frontAfter(5, {Modality::kRadar}), 0.95);
  EXPECT_LT(frontAfter(5, {Modality::kCamera}), 0.8);
  EXPECT_GT(frontAfter(5, {Modality::kCamera}), 0.5);
  EXPECT_GT(frontAfter(20, {Modality::kCamera}), 0.95);
}

TEST(Scene, AStandingCarOfUnknownFrontIsShownAsItsSideOfTheRoadFaces) {
  FilterModel model;
  model.classes = test::pedestrianAndCar();
  for (ObjectClass& c : model.classes.classes) c.motion = findMotionModel("wheeled");
  Track track = *oneCar(0.1).tracks[0];
  for (ClassFilter& f : track.bank) f.oriented = true;
  const Hypothesis one(TrackTable{std::make_shared<const Track>(track)});
  EgoState ego;  // the car stands at (10, 3) with a yaw of 0
  ego.stamp = test::kFirstStamp;
  const auto yaw = [&](const SceneParams& params) {
    return std::abs(SceneFromPosterior(model, params).make(one, ego, 0).objects.at(0).yaw);
  };
  SceneParams left;
  left.traffic = TrafficSide::kLeft;
  EXPECT_NEAR(yaw({}), kPi, 1e-9) << "traffic keeps to the right";
  EXPECT_NEAR(yaw(left), 0, 1e-9);
  model.params.heading = HeadingMode::kWide;
  EXPECT_NEAR(yaw({}), 0, 1e-9);
}

TEST(Scene, AForgottenIdIsNotGivenAgain) {
  FilterModel model;
  model.classes = test::pedestrianAndCar();
  SceneFromPosterior scenes(model, {});
  EgoState ego;
  ego.stamp = test::kFirstStamp;
  const Hypothesis one = oneCar(0.1);
  EXPECT_EQ(scenes.make(one, ego, 0).objects.at(0).id, 1U);
  EXPECT_EQ(scenes.keepOnly({1}), std::set<std::uint64_t>{1});
  EXPECT_EQ(scenes.make(one, ego, 0).objects.at(0).id, 1U) << "it lives";
  EXPECT_TRUE(scenes.keepOnly({}).empty());
  EXPECT_EQ(scenes.make(one, ego, 0).objects.at(0).id, 2U);
  EXPECT_EQ(scenes.objectsSoFar(), 2U);
}

}  // namespace
}  // namespace perception
