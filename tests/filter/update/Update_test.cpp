#include "libperception/filter/update/Update.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "libperception/core/math/Random.h"
#include "libperception/filter/Step.h"
#include "libperception/filter/predict/Prediction.h"
#include "libperception/measurement/models/DetectionModel.h"
#include "tests/support/FilterWorld.h"

namespace perception {
namespace {

using test::exactModel;
using test::linearClasses;
using test::linearSensor;
using test::positionScan;

struct UpdateFixture {
  std::shared_ptr<const PositionModel> sensor =
      std::make_shared<const PositionModel>(linearSensor());
  FilterModel model = exactModel(linearClasses());

  Track born() const {
    const auto scan = positionScan(sensor, 0, {{1, 2, 0}});
    return newTrack(likelihoodTable({}, scan, model).births[0], 0, scan, 0, model);
  }
};

TEST(NewTrack, IsABernoulliOfBirthAgainstClutter) {
  const UpdateFixture f;
  const Track t = f.born();
  const auto& p = f.sensor->params();
  const double birth = p.births_per_scan * (0.6 * 0.7 + 0.4 * 0.4),
               clutter = p.clutter_per_scan * 0.5;
  EXPECT_NEAR(t.existence, birth / (birth + clutter), 1e-12);
  EXPECT_NEAR(std::exp(t.log_class[0]), 0.6 * 0.7 / (0.6 * 0.7 + 0.4 * 0.4), 1e-12);
}

TEST(MissTrack, CostsExistenceAndTheClassesThatShouldHaveBeenSeen) {
  const UpdateFixture f;
  const Track before = predictTrack(f.born(), Stamp::fromSeconds(1000.1), f.model);
  const auto scan = positionScan(f.sensor, 0.1, {});
  const auto table = likelihoodTable({before}, scan, f.model);
  const Track after = missTrack(before, table.tracks[0], scan, f.model);
  const auto pc = classProbabilities(before);
  const double detection = pc[0] * 0.8 + pc[1] * 0.6;
  EXPECT_NEAR(after.existence,
              before.existence * (1 - detection) / (1 - before.existence * detection), 1e-12);
  EXPECT_NEAR(std::exp(after.log_class[0]), pc[0] * 0.2 / (1 - detection), 1e-12);
}

/// Log-odds of the first class against the second after a hit by a sensor that detects the first
/// one with that probability.
double oddsAfterHit(double detection) {
  UpdateFixture f;
  const Track before = predictTrack(f.born(), Stamp::fromSeconds(1000.1), f.model);
  PositionModel::Params params = linearSensor();
  params.classes[0].detection = detection;
  f.sensor = std::make_shared<const PositionModel>(params);
  const auto scan = positionScan(f.sensor, 0.1, {{1.05, 2, 0}});
  const auto table = likelihoodTable({before}, scan, f.model);
  const TrackLikelihoods& row = table.tracks[0];
  const Track after = hitTrack(before, row, row.pairs.at(0), scan, 1, f.model);
  return after.log_class[0] - after.log_class[1];
}

TEST(HitTrack, ADetectionByASensorThatNeverSeesAClassDoesNotRuleItOut) {
  ClassDetection never;
  never.detection = 0;
  const DetectionModel table({}, {never, {}}, {"a", "b"});
  const double least = table.row(0).detection;
  EXPECT_EQ(oddsAfterHit(0), -std::numeric_limits<double>::infinity()) << "no model says that";
  EXPECT_NEAR(oddsAfterHit(least) - oddsAfterHit(0.8), std::log(0.001 / 0.8), 1e-9);
}

TEST(HitTrack, MakesExistenceCertainAndClassesSumToOne) {
  UpdateFixture f;
  f.model.params.existence_max = 0.999;
  f.model.params.class_epsilon = 1e-3;
  const Track before = predictTrack(f.born(), Stamp::fromSeconds(1000.1), f.model);
  const auto scan = positionScan(f.sensor, 0.1, {{1.05, 2, 0}});
  const auto table = likelihoodTable({before}, scan, f.model);
  ASSERT_EQ(table.tracks[0].pairs.size(), 1u);
  const Track after = hitTrack(before, table.tracks[0], table.tracks[0].pairs[0], scan, 1, f.model);
  EXPECT_EQ(after.existence, 0.999);
  const auto p = classProbabilities(after);
  EXPECT_NEAR(std::accumulate(p.begin(), p.end(), 0.0), 1, 1e-12);
  EXPECT_NE(after.history, before.history);
  EXPECT_EQ(after.hits[modalityIndex(scan.modality)], 2);
}

TEST(HitTrack, FindsAnOncomingCarAtItsSecondScan) {
  UpdateFixture f;
  ObjectClass& car = f.model.classes.classes[0];
  car.motion = findMotionModel("wheeled");
  car.max_speed = 50;
  f.model.params.gate_probability = 0.999;
  const auto second = positionScan(f.sensor, 0.1, {{1 - 2.8, 2, 0}});  // 28 m/s
  const auto pairs = [&](double fast) {
    f.model.params.fast_births = fast;
    const Track t = predictTrack(f.born(), second.state.stamp, f.model);
    return likelihoodTable({t}, second, f.model).tracks[0].pairs.size();
  };
  EXPECT_EQ(pairs(0), 0u) << "5.6 standard deviations of 5 m/s";
  ASSERT_EQ(pairs(0.1), 1u);
  const Track t = predictTrack(f.born(), second.state.stamp, f.model);
  const auto table = likelihoodTable({t}, second, f.model);
  const Track hit = hitTrack(t, table.tracks[0], table.tracks[0].pairs[0], second, 1, f.model);
  const ClassFilter& filter = hit.bank[0];
  EXPECT_TRUE(filter.modes.empty()) << "settled";
  const double speed = filter.oriented ? std::abs(filter.x[2]) : filter.x.tail<2>().norm();
  EXPECT_NEAR(speed, 28, 3);
}

TEST(NewTrack, APartOfSomethingLongerIsNotFast) {
  UpdateFixture f;
  f.model.classes.classes[0].motion = findMotionModel("wheeled");
  f.model.classes.classes[0].max_speed = 50;
  f.model.params.fast_births = 0.1;
  auto scan = positionScan(f.sensor, 0, {{1, 2, 0}});
  const auto modes = [&] {
    return newTrack(likelihoodTable({}, scan, f.model).births[0], 0, scan, 0, f.model)
        .bank[0]
        .modes.size();
  };
  EXPECT_EQ(modes(), 2u);
  PartialBox sides;
  sides.length = 4.5, sides.width = 0.1;
  scan.measurements[0].sides = sides;
  scan.measurements[0].sides->length_complete = scan.measurements[0].sides->width_complete = false;
  EXPECT_EQ(modes(), 0u);
  scan.measurements[0].sides->length_complete = true;
  EXPECT_EQ(modes(), 2u);
}

TEST(HitTrack, NeverLetsAClassDie) {
  UpdateFixture f;
  f.model.params.class_epsilon = 1e-3;
  Track t = f.born();
  for (int i = 1; i <= 200; ++i) {  // a steady walk: nothing static about it
    const auto scan = positionScan(f.sensor, 0.1 * i, {{1 + 0.15 * i, 2, 0}});
    const Track predicted = predictTrack(t, scan.state.stamp, f.model);
    const auto table = likelihoodTable({predicted}, scan, f.model);
    ASSERT_EQ(table.tracks[0].pairs.size(), 1u) << i;
    t = hitTrack(predicted, table.tracks[0], table.tracks[0].pairs[0], scan,
                 static_cast<std::uint64_t>(i), f.model);
  }
  const auto p = classProbabilities(t);
  EXPECT_GT(p[0], 0.99);
  EXPECT_GE(p[1], 0.9e-3);
  // The filter that lost it starts anew from the measurement instead of hanging behind.
  EXPECT_NEAR(t.bank[1].x[0], 1 + 0.15 * 200, 2);
}

TEST(Gate, KeepsExactlyTheQuantile) {
  const UpdateFixture f;
  FilterModel model = f.model;
  model.params.gate_probability = 0.999;
  const Track t = predictTrack(f.born(), Stamp::fromSeconds(1000), model);
  // The walker's innovation covariance at dt = 0 is its birth covariance plus its noise: isotropic.
  const double variance = 2 * (0.04 + 1e-4) + 1e-9, static_variance = 2 * (0.09 + 1e-4) + 1e-9;
  const double quantile = 13.815510557964274;  // chi-square .999, two degrees of freedom
  const double edge = std::sqrt(quantile * std::max(variance, static_variance));
  for (const double factor : {0.9999, 1.0001}) {
    const auto scan = positionScan(f.sensor, 0, {{1 + factor * edge, 2, 0}});
    EXPECT_EQ(likelihoodTable({t}, scan, model).tracks[0].pairs.size(), factor < 1 ? 1u : 0u);
  }
}

TEST(Prediction, FadesWhatNobodyCouldSee) {
  UpdateFixture f;
  f.model.params.survival_in_view = 60;
  f.model.params.survival_out_of_view = 6;
  Track t = f.born();
  t.existence = 0.9;
  EXPECT_NEAR(predictTrack(t, t.stamp + 0.5, f.model).existence, 0.9 * std::exp(-0.5 / 60), 1e-12);
  // In view for one more second, in one step or in several.
  const double later = 0.9 * std::exp(-1.0 / 60 - 2.0 / 6);
  EXPECT_NEAR(predictTrack(t, t.stamp + 3.0, f.model).existence, later, 1e-12);
  const Track between = predictTrack(t, t.stamp + 1.3, f.model);
  EXPECT_NEAR(predictTrack(between, t.stamp + 3.0, f.model).existence, later, 1e-12);
}

/// A scan with one measurement at (1, 2) that says so much of its classes by itself.
MeasurementScan scoredScan(const UpdateFixture& f, double t, std::vector<double> log_class,
                           double log_clutter) {
  auto scan = positionScan(f.sensor, t, {{1, 2, 0}});
  scan.measurements[0].log_class = std::move(log_class);
  scan.measurements[0].log_clutter = log_clutter;
  return scan;
}

TEST(NewTrack, EvidenceByClassStandsInPlaceOfLabelAndScore) {
  const UpdateFixture f;
  const auto scan = scoredScan(f, 0, {1.5, -0.5}, -0.2);
  const Track t = newTrack(likelihoodTable({}, scan, f.model).births[0], 0, scan, 0, f.model);
  const auto& p = f.sensor->params();
  const double walker = 0.6 * std::exp(1.5), thing = 0.4 * std::exp(-0.5);
  const double birth = p.births_per_scan * (walker + thing);
  EXPECT_NEAR(t.existence, birth / (birth + p.clutter_per_scan * std::exp(-0.2)), 1e-12);
  EXPECT_NEAR(std::exp(t.log_class[0]), walker / (walker + thing), 1e-12);
}

TEST(HitTrack, EvidenceByClassMovesTheClassesByItsRatio) {
  const UpdateFixture f;
  const Track before = predictTrack(f.born(), Stamp::fromSeconds(1000.1), f.model);
  const auto after = [&](std::vector<double> log_class) {
    const auto scan = scoredScan(f, 0.1, std::move(log_class), 0);
    const auto table = likelihoodTable({before}, scan, f.model);
    return hitTrack(before, table.tracks[0], table.tracks[0].pairs.at(0), scan, 1, f.model);
  };
  const Track even = after({0, 0}), tilted = after({1.25, 0});
  EXPECT_NEAR((tilted.log_class[0] - tilted.log_class[1]) - (even.log_class[0] - even.log_class[1]),
              1.25, 1e-9);
}

TEST(HitTrack, FacingFollowsTheAxisAndTheMajorityOfDirections) {
  const UpdateFixture f;
  const auto body_heading = [&](double t, double yaw) {
    auto scan = positionScan(f.sensor, t, {{1, 2, 0}});
    scan.measurements[0].heading = MeasuredHeading{yaw, 0.1, 0.1};
    return scan;
  };
  const auto first = body_heading(0, 0.5);
  Track track = newTrack(likelihoodTable({}, first, f.model).births[0], 0, first, 0, f.model);
  ASSERT_TRUE(track.body_heading);
  EXPECT_NEAR(track.body_heading->mean, 0.5, 1e-12);
  std::uint64_t index = 0;
  for (const double yaw : {0.5 + kPi, 0.6, 0.5, 0.5 + kPi, 0.6}) {
    const double t = 0.1 * static_cast<double>(++index);
    const auto scan = body_heading(t, yaw);
    track = predictTrack(track, Stamp::fromSeconds(1000 + t), f.model);
    const auto table = likelihoodTable({track}, scan, f.model);
    track = hitTrack(track, table.tracks[0], table.tracks[0].pairs.at(0), scan, index, f.model);
  }
  EXPECT_NEAR(wrapAngle(track.body_heading->mean), 0.55, 0.1);
  EXPECT_LT(track.body_heading->variance, 0.01);
}

/// A walker of 1 m/s, seen at 10 Hz with labels that speak for it, under a hard decision at .99.
Track walkerAfter(const UpdateFixture& f, int scans, double jump = 0) {
  Track track = f.born();
  for (int i = 1; i <= scans; ++i) {
    const double t = 0.1 * i;
    const double x = 1 + t + (i == scans ? jump : 0);
    auto scan = positionScan(f.sensor, t, {{x, 2, 0}});
    scan.measurements[0].log_class = {1.0, 0.0};
    track = predictTrack(track, scan.state.stamp, f.model);
    const auto table = likelihoodTable({track}, scan, f.model);
    track = hitTrack(track, table.tracks[0], table.tracks[0].pairs.at(0), scan,
                     static_cast<std::uint64_t>(i), f.model);
  }
  return track;
}

TEST(DecidedClass, GoesOnAloneLikeInAFullBank) {
  UpdateFixture f;
  const Track full = walkerAfter(f, 30);
  f.model.params.decide_class = 0.99;
  const Track track = walkerAfter(f, 30);
  EXPECT_EQ(full.decided_class, -1);
  ASSERT_EQ(track.decided_class, 0);
  EXPECT_TRUE(track.bank[0].x.isApprox(full.bank[0].x, 1e-12));
  EXPECT_TRUE(track.bank[0].P.isApprox(full.bank[0].P, 1e-12));
  EXPECT_NE(track.bank[1].x[0], full.bank[1].x[0]) << "the other filter rests";
}

TEST(DecidedClass, ASurpriseWidensTheBankAtTheSamePlace) {
  UpdateFixture f;
  f.model.params.decide_class = 0.99;
  const Track track = walkerAfter(f, 30, 1.5);
  EXPECT_EQ(track.decided_class, -1);
  EXPECT_TRUE((track.bank[1].x.head<2>().isApprox(track.bank[0].x.head<2>(), 1e-12)));
  EXPECT_EQ(track.bank[1].x[2], 0) << "a static object has no velocity";
}

TEST(DecidedClass, LabelsOfAnotherClassTakeTheDecisionBack) {
  UpdateFixture f;
  f.model.params.decide_class = 0.99;
  f.model.params.class_epsilon = 1e-3;
  Track track = walkerAfter(f, 30);
  ASSERT_EQ(track.decided_class, 0);
  for (int i = 1; i <= 20 && track.decided_class == 0; ++i) {
    auto scan = positionScan(f.sensor, 3 + 0.1 * i, {{4 + 0.1 * i, 2, 0}});
    scan.measurements[0].log_class = {0.0, 1.0};
    track = predictTrack(track, scan.state.stamp, f.model);
    const auto table = likelihoodTable({track}, scan, f.model);
    track = hitTrack(track, table.tracks[0], table.tracks[0].pairs.at(0), scan, 100, f.model);
  }
  EXPECT_NE(track.decided_class, 0);
}

/// How often a decided bank is wide again: a walker seen with the sensor's own noise for 400 scans,
/// whose steps begin to be `jerk` [m] long at random from scan 200 on.
struct Widened {
  int steady = 0, restless = 0;
  explicit Widened(double jerk) {
    UpdateFixture f;
    f.model.params.decide_class = 0.99;
    f.model.params.class_epsilon = 1e-3;
    Rng rng({7, 0, 0, 0xdec1});
    Track track = f.born();
    double x = 1;
    for (int i = 1; i <= 400; ++i) {
      x += 0.1 + (i > 200 ? jerk * rng.normal() : 0);
      auto scan =
          positionScan(f.sensor, 0.1 * i, {{x + 0.2 * rng.normal(), 2 + 0.2 * rng.normal(), 0}});
      scan.measurements[0].log_class = {1.0, 0.0};
      track = predictTrack(track, scan.state.stamp, f.model);
      const auto table = likelihoodTable({track}, scan, f.model);
      if (table.tracks[0].pairs.empty()) continue;
      track = hitTrack(track, table.tracks[0], table.tracks[0].pairs[0], scan,
                       static_cast<std::uint64_t>(i), f.model);
      if (i > 50) (i > 200 ? restless : steady) += track.decided_class < 0;
    }
  }
};

TEST(DecidedClass, NisSaysWhenToWidenOnceInAHundredScansElseOnlyWhenItIsDue) {
  // The sensor's noise is .04 m^2: NIS is chi-square with two degrees of freedom, so one scan in a
  // hundred surprises. Of 150: 1.5 with a deviation of 1.2; five deviations for the bound.
  const Widened honest(0), jumping(0.6);
  EXPECT_LE(honest.steady, 1.5 + 5 * 1.2);
  EXPECT_EQ(jumping.steady, honest.steady) << "until it jumps they are the same";
  EXPECT_GT(jumping.restless, 5 * (honest.restless + 1));
}

TEST(LikelihoodTable, HiddenObjectsKeepTheirShareOfDetection) {
  UpdateFixture f;
  f.model.params.occluded_detection = 0.25;
  const Track track = predictTrack(f.born(), Stamp::fromSeconds(1000.1), f.model);
  auto scan = positionScan(f.sensor, 0.1, {});
  auto occlusion = std::make_shared<OcclusionMap>(Vector2(0, 0), 360);
  for (double bearing = 0; bearing < kTwoPi; bearing += 0.01)
    occlusion->add({0.5 * std::cos(bearing), 0.5 * std::sin(bearing)});
  f.model.params.occlusion_tolerance = 0.1;
  const double open = likelihoodTable({track}, scan, f.model).tracks[0].detection;
  scan.occlusion = occlusion;
  EXPECT_NEAR(likelihoodTable({track}, scan, f.model).tracks[0].detection, 0.25 * open, 1e-12);
}

}  // namespace
}  // namespace perception
