#include "libperception/evaluation/metrics/Metrics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/evaluation/MakeRun.h"

namespace perception {
namespace {

using namespace testing_evaluation;

constexpr double kTiny = 1e-9;

// A run whose scene k holds estimates[k], against the truth.
Evaluation compare(const std::vector<std::vector<SceneObject>>& estimates,
                   const std::vector<TruthObject>& truth, const EvaluationOptions& options = {}) {
  TrackedRun run = makeRun();
  for (std::size_t k = 0; k < estimates.size(); ++k) {
    run.scenes.push_back(makeScene(static_cast<std::int64_t>(k), estimates[k]));
  }
  return evaluate(run, makeGroundTruth(truth), options);
}

TEST(Metrics, SharingLetsOneEstimateTrackTwoTruths) {
  const Evaluation e =
      compare({{makeObject(1, 10, 0)}}, {makeTruth(0, 1, 10, -0.5), makeTruth(0, 2, 10, 1)});
  EXPECT_EQ(trackingFigures(e, Pairing::kClosest).tracked_a, 1);
  EXPECT_EQ(trackingFigures(e, Pairing::kOneToOne).tracked_a, 0.5);
  EXPECT_EQ(trackingFigures(e, Pairing::kOneToOne).returns, 1u);
}

TEST(Metrics, MotaCountsMissesFalseObjectsAndSwitches) {
  EvaluationOptions options;
  options.exclusion = options.tolerance;
  // Four instants of one car: tracked, missed, another id, and that one twice; a stray output in
  // the first, 2.5 m beside the car.
  const Evaluation e = compare({{makeObject(1, 10, 0), makeObject(5, 10, 2.5)},
                                {},
                                {makeObject(2, 10, 0)},
                                {makeObject(2, 10, 0), makeObject(3, 10, 1)}},
                               {makeTruth(0, 1, 10, 0), makeTruth(1, 1, 10, 0),
                                makeTruth(2, 1, 10, 0), makeTruth(3, 1, 10, 0)},
                               options);
  const ClearFigures f = clearFigures(e);
  EXPECT_EQ(f.truth, 4u);
  EXPECT_EQ(f.misses, 1u);
  EXPECT_EQ(f.false_objects, 2u);
  EXPECT_EQ(f.id_switches, 1u);
  EXPECT_NEAR(*f.mota, 0, kTiny);
  EXPECT_FALSE(clearFigures(compare({{}}, {makeTruth(0, 1, 90, 0)})).mota);  // no truth counts
}

TEST(Metrics, InstantsWithoutEstimatesCountAsMissedFromTheFirstOn) {
  const Evaluation e = compare({{}, {makeObject(1, 10, 0)}, {}, {makeObject(1, 10, 0)}},
                               {makeTruth(0, 1, 10, 0), makeTruth(1, 1, 10, 0),
                                makeTruth(2, 1, 10, 0), makeTruth(3, 1, 10, 0)});
  const TrackingFigures f = trackingFigures(e, Pairing::kClosest);
  EXPECT_EQ(f.active, 4u);
  EXPECT_EQ(f.tracked_a, 0.5);
  EXPECT_NEAR(*f.tracked_c, 2.0 / 3, kTiny);  // from the first to the last tracked instant
}

TEST(Metrics, TheThreeDenominatorsDiffer) {
  EvaluationOptions options;
  options.sensors = "C+R";
  // A car at 14 m (within the camera's 15 m) tracked, one at 18 m not, a person at 12 m (beyond 10
  // m) not, one at 9 m tracked.
  const Evaluation e = compare(
      {{makeObject(1, 14, 0), makeObject(2, 9, 5, kPedestrian)}},
      {makeTruth(0, 1, 14, 0), makeTruth(0, 2, 18, 0), makeTruth(0, 3, 12, -4, "Pedestrian"),
       makeTruth(0, 4, std::sqrt(81 - 25.0), 5, "Pedestrian")},
      options);
  const TrackingFigures f = trackingFigures(e, Pairing::kClosest);
  EXPECT_EQ(f.tracked_a, 0.5);
  EXPECT_EQ(f.in_sensor_range, 2u);
  EXPECT_EQ(f.tracked_b, 1);
  EXPECT_EQ(f.tracked_c, 1);
  options.sensors = "C+L+R";
  const Evaluation with_lidar = compare({{}}, {makeTruth(0, 2, 18, 0)}, options);
  EXPECT_EQ(trackingFigures(with_lidar, Pairing::kClosest).tracked_b, 0);
}

TEST(Metrics, ReturnsBeyondTheSensorSetsRangeAreNoneOfItsShare) {
  EvaluationOptions options;
  options.sensors = "C+R";
  const Evaluation e =
      compare({{makeObject(1, 18, 0)}}, {makeTruth(0, 1, 18, 0), makeTruth(0, 2, 8, 3)}, options);
  EXPECT_EQ(trackingFigures(e, Pairing::kClosest).tracked_a, 0.5);
  EXPECT_EQ(trackingFigures(e, Pairing::kClosest).tracked_b, 0);
}

TEST(Metrics, TheSensorSetIsWhatHitAnObject) {
  SceneObject object = makeObject(1, 5, 0);
  object.last_hit = {{Modality::kRadar, {}}, {Modality::kCamera, {}}};
  EXPECT_EQ(compare({{object}}, {makeTruth(0, 1, 5, 0)}).sensors, "CR");
  EXPECT_EQ(compare({{}}, {makeTruth(0, 1, 5, 0)}).sensors, "");
}

TEST(Metrics, RangeErrorIsOfTheClosestPointsOfTheFootprints) {
  // The same near side, but the estimate is 2 m longer: closest points agree, centers are 1 m
  // apart.
  TruthObject truth = makeTruth(0, 1, 12, 0);
  truth.length = 4;
  truth.width = 2;
  SceneObject estimate = makeObject(1, 13, 0);
  estimate.length = 6;
  estimate.width = 2;
  const TrackingFigures f = trackingFigures(compare({{estimate}}, {truth}), Pairing::kClosest);
  EXPECT_NEAR(*f.range_rms, 0, kTiny);
  EXPECT_NEAR(*f.center_range_rms, 1, kTiny);
  EXPECT_NEAR(*f.position_rms, 1, kTiny);
}

TEST(Metrics, BearingAndHeadingErrorsWrap) {
  EvaluationOptions options;
  options.selection.fov = kTwoPi;
  TruthObject truth = makeTruth(0, 1, -10, 0.5);
  truth.yaw = radians(179);
  SceneObject estimate = makeObject(1, -10, -0.5);
  estimate.yaw = radians(-179);
  const TrackingFigures f =
      trackingFigures(compare({{estimate}}, {truth}, options), Pairing::kClosest);
  EXPECT_NEAR(*f.bearing_rms, 2 * std::atan(0.05), kTiny);
  EXPECT_NEAR(*f.heading_rms, radians(2), kTiny);
  EXPECT_EQ(f.heading_reversed, 0);
}

TEST(Metrics, AReversedHeadingIsSeen) {
  TruthObject truth = makeTruth(0, 1, 10, 0);
  truth.yaw = 0;
  SceneObject estimate = makeObject(1, 10, 0);
  estimate.yaw = 3;
  const TrackingFigures f = trackingFigures(compare({{estimate}}, {truth}), Pairing::kClosest);
  EXPECT_EQ(f.heading_reversed, 1);
  estimate.has_yaw = false;
  EXPECT_FALSE(trackingFigures(compare({{estimate}}, {truth}), Pairing::kClosest).heading_rms);
}

TEST(Metrics, ReversedHeadingsAreCountedApartWhereTheFrontIsKnown) {
  std::vector<TruthObject> truth;
  for (int i = 0; i < 5; ++i) {
    truth.push_back(makeTruth(i, 1, 10, 0));
    truth.back().yaw = 0;
  }
  SceneObject guess = makeObject(1, 10, 0), known = guess;
  guess.yaw = 3, guess.p_front = 0.6;
  known.yaw = 0, known.p_front = 0.9;
  const Evaluation e = compare({{guess}, {known}, {guess}, {known}, {guess}}, truth);
  const TrackingFigures f = trackingFigures(e, Pairing::kClosest);
  EXPECT_EQ(f.heading_reversed, 0.6);
  EXPECT_EQ(f.heading_sure, 0.4);
  EXPECT_EQ(f.heading_sure_reversed, 0);
  EXPECT_NEAR(*frontReliability(e, Pairing::kClosest).calibration_error, 0.6 * 0.6 + 0.4 * 0.1,
              kTiny);
}

TEST(Metrics, FrontsOfWhatStandsAndOfWhatMovesAreCountedApart) {
  std::vector<TruthObject> truth;
  for (int i = 0; i < 5; ++i) {
    truth.push_back(makeTruth(i, 1, 10, 0));
    truth.back().yaw = 0;
    if (i < 4) truth.back().vx = i < 2 ? 0.4 : 5, truth.back().vy = 0;
  }
  SceneObject guess = makeObject(1, 10, 0), known = guess, none = guess;
  guess.yaw = 3, guess.p_front = 0.5;
  known.yaw = 0, known.p_front = 0.9;
  none.has_yaw = false;
  const Evaluation e = compare({{guess}, {none}, {known}, {guess}, {known}}, truth);
  const FrontFigures all = frontFigures(e, Pairing::kOneToOne),
                     standing = frontFigures(e, Pairing::kOneToOne, -1, TruthMotion::kStanding),
                     moving = frontFigures(e, Pairing::kOneToOne, kCar, TruthMotion::kMoving);
  EXPECT_EQ(all.matched, 5u);
  EXPECT_EQ(all.with_heading, 0.8);
  EXPECT_EQ(all.front_known, 0.4);
  EXPECT_EQ(all.known_reversed, 0);
  EXPECT_EQ(all.other_reversed, 1);
  EXPECT_EQ(standing.matched, 2u);
  EXPECT_EQ(standing.with_heading, 0.5);
  EXPECT_EQ(standing.front_known, 0);
  EXPECT_FALSE(standing.known_reversed);
  EXPECT_NEAR(*standing.calibration_error, 0.5, kTiny);
  EXPECT_EQ(moving.matched, 2u) << "a truth without velocity is in neither";
  EXPECT_EQ(moving.front_known, 0.5);
  EXPECT_EQ(moving.known_reversed, 0);
  EXPECT_NEAR(*moving.calibration_error, 0.5 * 0.1 + 0.5 * 0.5, kTiny);
  EXPECT_EQ(frontFigures(e, Pairing::kOneToOne, kPedestrian).matched, 0u);
}

TEST(Metrics, SpeedIsJudgedOnlyWhereTheTruthHasOne) {
  TruthObject moving = makeTruth(0, 1, 10, 0);
  moving.vx = 3;
  moving.vy = 4;
  SceneObject estimate = makeObject(1, 10, 0);
  estimate.velocity = {0, 6};
  const Evaluation e = compare({{estimate}, {estimate}}, {moving, makeTruth(1, 1, 10, 0)});
  const TrackingFigures f = trackingFigures(e, Pairing::kClosest);
  EXPECT_NEAR(*f.speed_rms, 1, kTiny);
  EXPECT_NEAR(*f.velocity_rms, std::sqrt(13.0), kTiny);
  EXPECT_FALSE(trackingFigures(compare({{estimate}}, {makeTruth(0, 1, 10, 0)}), Pairing::kClosest)
                   .speed_rms);
}

TEST(Metrics, CorrectMisAndUnclassifiedSumToOne) {
  const Evaluation e = compare(
      {{makeObject(1, 10, 0)},
       {makeObject(1, 10, 0, kCar, .94)},
       {makeObject(1, 10, 0, kPedestrian)},
       {makeObject(1, 10, 0)},
       {}},
      {makeTruth(0, 1, 10, 0, "Van"), makeTruth(1, 1, 10, 0, "Van"), makeTruth(2, 1, 10, 0, "Van"),
       makeTruth(3, 1, 10, 0, "Van"), makeTruth(4, 1, 10, 0, "Van")});
  const TrackingFigures f = trackingFigures(e, Pairing::kClosest);
  EXPECT_EQ(f.returns, 4u);
  EXPECT_EQ(f.correct, 0.5);
  EXPECT_EQ(f.mis, 0.25);
  EXPECT_EQ(f.unclassified, 0.25);
  const Confusion::Row row = confusion(e, Pairing::kOneToOne).by_type.at("Van");
  EXPECT_EQ(row.classified, (std::vector<std::size_t>{1, 2, 0}));
  EXPECT_EQ(row.unclassified, 1u);
  EXPECT_EQ(row.missed, 1u);
}

TEST(Metrics, ClassesAreJudgedApart) {
  const Evaluation e = compare({{makeObject(1, 10, 0)}},
                               {makeTruth(0, 1, 10, 0), makeTruth(0, 2, 5, 5, "Person_sitting")});
  EXPECT_EQ(trackingFigures(e, Pairing::kClosest, kCar).tracked_a, 1);
  EXPECT_EQ(trackingFigures(e, Pairing::kClosest, kPedestrian).tracked_a, 0);
  EXPECT_FALSE(trackingFigures(e, Pairing::kClosest, kStaticOther).tracked_a);
}

TEST(Metrics, IdSwitchesAndFragmentationsAreCountedOverGaps) {
  // ids 1 1 - 2 2 1 - -: two switches (1 to 2 over a gap, 2 to 1), one gap between tracked
  // instants.
  const auto at = [](std::uint64_t id) { return std::vector<SceneObject>{makeObject(id, 10, 0)}; };
  std::vector<TruthObject> truth;
  for (std::int64_t k = 0; k < 8; ++k) truth.push_back(makeTruth(k, 4, 10, 0));
  const Evaluation e = compare({at(1), at(1), {}, at(2), at(2), at(1), {}, {}}, truth);
  const TrackingFigures f = trackingFigures(e, Pairing::kOneToOne);
  EXPECT_EQ(f.id_switches, 2u);
  EXPECT_EQ(f.fragmentations, 1u);
  const auto lines = objectTimelines(e, Pairing::kOneToOne);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].ids, (std::vector<std::uint64_t>{1, 2}));
  EXPECT_EQ(lines[0].first_to_last, 6u);
  EXPECT_NEAR(lines[0].last_active, 0.7, kTiny);
}

TEST(Metrics, TimeToFirstTrackStartsWhenTheObjectCounts) {
  const std::vector<SceneObject> none, seen = {makeObject(9, 10, 0)};
  const Evaluation e =
      compare({none, none, none, seen},
              {makeTruth(0, 1, 30, 0), makeTruth(1, 1, 15, 0), makeTruth(2, 1, 12, 0),
               makeTruth(3, 1, 10, 0), makeTruth(0, 2, 3, 3), makeTruth(1, 2, 3, 3)});
  const auto lines = objectTimelines(e, Pairing::kOneToOne);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].id, 2);
  EXPECT_FALSE(lines[0].time_to_first_track);
  EXPECT_EQ(lines[0].tracked, 0);
  EXPECT_NEAR(*lines[1].time_to_first_track, 0.2, kTiny);
}

TEST(Metrics, TruthCountsOnlyUnderTheRules) {
  TruthObject hidden = makeTruth(0, 1, 10, 0), sparse = makeTruth(0, 2, 10, 3),
              ignored = makeTruth(0, 3, 10, 6), uncounted = makeTruth(0, 4, 5, 8);
  hidden.occluded = 3;
  sparse.lidar_points = 19;
  ignored.ignore = true;
  uncounted.lidar_points = -1;
  const Evaluation e = compare(
      {{}}, {hidden, sparse, ignored, uncounted, makeTruth(0, 5, 21, 0), makeTruth(0, 6, -1, 0),
             makeTruth(0, 7, 6, 0, "Tram"), makeTruth(0, 8, 4, 0, "DontCare")});
  ASSERT_EQ(e.samples.size(), 1u);
  EXPECT_EQ(e.samples[0].id, 4);
  const auto used = [&](TruthUse use) { return e.truth_use[static_cast<std::size_t>(use)]; };
  EXPECT_EQ(used(TruthUse::kCounts), 1u);
  EXPECT_EQ(used(TruthUse::kOutside), 2u);
  EXPECT_EQ(used(TruthUse::kIgnored), 2u);
  EXPECT_EQ(used(TruthUse::kNoClass), 1u);
  EXPECT_EQ(used(TruthUse::kOccluded), 1u);
  EXPECT_EQ(used(TruthUse::kFewPoints), 1u);
}

TEST(Metrics, TruthOutsideMayNotBeTrackedButAnEstimateOutsideMayTrack) {
  const Evaluation e =
      compare({{makeObject(1, 20.5, 0)}}, {makeTruth(0, 1, 19.5, 0), makeTruth(0, 2, 20.6, 0)});
  EXPECT_EQ(trackingFigures(e, Pairing::kClosest).active, 1u);
  EXPECT_EQ(trackingFigures(e, Pairing::kClosest).returns, 1u);
  EXPECT_EQ(e.instants.at(0).gospa.missed, 0);  // the set distance takes the same pair
}

TEST(FalseObjects, AreNamedInTheSectorAndFarFromAnyTruth) {
  TruthObject ignored = makeTruth(0, 2, 0, 10, "Misc");
  ignored.ignore = true;
  TruthObject hidden = makeTruth(0, 3, 0, -10);
  hidden.occluded = 3;
  TruthObject area = makeTruth(0, -1, 15, -10, "DontCare");
  area.ignore = true;
  const Evaluation e = compare({{makeObject(1, 10, 2.9),  // near a counted truth
                                 makeObject(2, 2, 10),    // near an ignored one
                                 makeObject(3, 2, -10),   // near a hidden one
                                 makeObject(4, 15, -8),   // in an area of which nothing is known
                                 makeObject(5, 5, 5, kStaticOther),           // not named
                                 makeObject(6, 25, 0), makeObject(7, -5, 0),  // outside
                                 makeObject(8, 10, 3.1),                      // false
                                 makeObject(9, 3, 3, kPedestrian, .6)}},  // false, not classified
                               {makeTruth(0, 1, 10, 0), ignored, hidden, area});
  const FalseObjectFigures all = falseObjectFigures(e);
  EXPECT_EQ(all.counts.named, 6u);
  EXPECT_EQ(all.counts.false_, 2u);
  EXPECT_EQ(all.per_instant, 2);
  EXPECT_NEAR(*all.share, 2.0 / 6, kTiny);
  EXPECT_EQ(all.counts.classified_false, 1u);
  EXPECT_NEAR(*all.classified_share, 1.0 / 5, kTiny);
  EXPECT_EQ(falseObjectFigures(e, kPedestrian).counts.false_, 1u);
  EXPECT_EQ(falseObjectFigures(e, kPedestrian).counts.classified_named, 0u);
  EXPECT_FALSE(falseObjectFigures(e, kPedestrian).classified_share);
}

TEST(FalseObjects, AnOutputOnALongVehicleIsNone) {
  TruthObject tram = makeTruth(0, 1, 10, 0, "Tram");
  tram.length = 18;
  tram.width = 2.5;
  EXPECT_EQ(falseObjectFigures(compare({{makeObject(1, 17, 1)}}, {tram})).counts.false_, 0u);
  EXPECT_EQ(falseObjectFigures(compare({{makeObject(1, 17, 2)}}, {tram})).counts.false_, 1u);
}

TEST(FalseObjects, AreOnlyWhereTheTruthKnowsEveryObject) {
  EvaluationOptions options;
  options.selection.complete_fov = radians(80);  // labels of a camera's view
  const Evaluation e =
      compare({{makeObject(1, 5, 8), makeObject(2, 12, -2)}}, {makeTruth(0, 1, 15, 6)}, options);
  EXPECT_EQ(falseObjectFigures(e).counts.false_, 1u);
  EXPECT_EQ(e.instants.at(0).estimates, 1u);
}

TEST(FalseObjects, InAnEmptyStreetCountWhenTheTruthIsSaidToBeComplete) {
  EvaluationOptions options;
  EXPECT_FALSE(falseObjectFigures(compare({{makeObject(1, 5, 0)}}, {}, options)).per_instant);
  options.alignment.empty_frames = true;
  EXPECT_EQ(falseObjectFigures(compare({{makeObject(1, 5, 0)}}, {}, options)).per_instant, 1);
}

TEST(SetFigures, PartsSumToTheMeanSquare) {
  const Evaluation e =
      compare({{makeObject(1, 10, 1), makeObject(2, 3, -8)}, {}, {}},
              {makeTruth(0, 1, 10, 0), makeTruth(1, 1, 10, 0), makeTruth(2, 1, -30, 0)});
  const SetFigures f = setFigures(e, 2);
  EXPECT_EQ(f.instants, 2u);  // in the third there is nothing
  EXPECT_NEAR(*f.gospa_mean, (std::sqrt(3.0) + std::sqrt(2.0)) / 2, kTiny);
  EXPECT_NEAR(*f.localization + *f.missed + *f.false_, *f.gospa_rms * *f.gospa_rms, kTiny);
  EXPECT_NEAR(*f.missed_objects, 0.5, kTiny);
  EXPECT_NEAR(*f.false_objects, 0.5, kTiny);
  EXPECT_NEAR(*f.localization_rms, 1, kTiny);
  EXPECT_NEAR(*f.ospa_mean, (std::sqrt(5.0 / 2) + 2) / 2, kTiny);
}

TEST(SetFigures, LeaveOutPolesAndEstimatesOfTruthThatDoesNotCount) {
  TruthObject hidden = makeTruth(0, 2, 5, 8);
  hidden.occluded = 3;
  const Evaluation e =
      compare({{makeObject(1, 10, 0), makeObject(2, 5, 8), makeObject(3, 5, -8, kStaticOther)}},
              {makeTruth(0, 1, 10, 0), hidden});
  EXPECT_EQ(e.instants.at(0).estimates, 1u);
  EXPECT_EQ(setFigures(e, 2).gospa_mean, 0);
}

TEST(Metrics, WhereNothingCanBeSaidThereIsNoFigure) {
  const Evaluation nothing = compare({{makeObject(1, 10, 0)}}, {});
  EXPECT_TRUE(nothing.instants.empty());
  const TrackingFigures f = trackingFigures(nothing, Pairing::kClosest);
  for (const Figure& figure : {f.tracked_a, f.tracked_b, f.tracked_c, f.range_rms, f.bearing_rms,
                               f.speed_rms, f.heading_rms, f.correct, f.mis, f.unclassified}) {
    EXPECT_FALSE(figure);
  }
  EXPECT_FALSE(setFigures(nothing, 2).gospa_mean);
  EXPECT_FALSE(falseObjectFigures(nothing).per_instant);
  EXPECT_FALSE(reliability(nothing, Pairing::kClosest).calibration_error);
  const TrackingFigures missed =
      trackingFigures(compare({{}}, {makeTruth(0, 1, 5, 0)}), Pairing::kClosest);
  EXPECT_EQ(missed.tracked_a, 0);  // this can be said
  EXPECT_FALSE(missed.range_rms);
  EXPECT_FALSE(missed.correct);
  EXPECT_FALSE(missed.tracked_c);
}

TEST(Reliability, ComparesStatedWithCorrect) {
  // Twice .8: once right, once wrong.
  const Evaluation e =
      compare({{makeObject(1, 10, 0, kCar, .8)}, {makeObject(1, 10, 0, kPedestrian, .8)}},
              {makeTruth(0, 1, 10, 0), makeTruth(1, 1, 10, 0)});
  const Reliability r = reliability(e, Pairing::kOneToOne);
  EXPECT_EQ(r.bins.at(8).count, 2u);
  EXPECT_NEAR(*r.bins[8].mean_probability, .8, kTiny);
  EXPECT_EQ(r.bins[8].correct, .5);
  EXPECT_NEAR(*r.calibration_error, .3, kTiny);
}

TEST(CountDifference, IsTheRmsOverCommonInstants) {
  TrackedRun a = makeRun(), b = makeRun();
  a.scenes = {makeScene(0, {makeObject(1, 1, 1), makeObject(2, 2, 2)}), makeScene(1), makeScene(5)};
  b.scenes = {makeScene(0, {makeObject(1, 1, 1, kCar, .5)}), makeScene(1, {makeObject(1, 1, 1)})};
  const CountDifference d = countDifference(a, b);
  EXPECT_EQ(d.instants, 2u);
  EXPECT_NEAR(*d.all, 1, kTiny);
  EXPECT_NEAR(*d.classified, std::sqrt(5.0 / 2), kTiny);
  EXPECT_FALSE(countDifference(a, makeRun()).all);
}

// A turning vehicle among cars and persons, as truth and as a run made of that truth, the estimates
// moved by `shift` [m].
Evaluation runOfTheTruth(const Vector2& shift) {
  TrackedRun run = makeRun();
  std::vector<TruthObject> truth;
  for (std::int64_t k = 0; k < 30; ++k) {
    const double t = 0.1 * static_cast<double>(k);
    Scene scene = makeScene(k);
    scene.ego.T_world_ego = makePose(3 * t, 0.2 * t, 0.3, 0.2 * t);
    for (std::int64_t id = 1; id <= 4; ++id) {
      const bool person = id == 4;
      TruthObject object =
          makeTruth(k, id, 6 + 5 * static_cast<double>(id) - t, 6 * static_cast<double>(id % 3 - 1),
                    person ? "Pedestrian" : "Car");
      object.yaw = wrapAngle(1.5 * static_cast<double>(id) + t);
      object.length = person ? .8 : 4;
      object.width = person ? .6 : 1.8;
      object.vx = -1;
      object.vy = 0;
      truth.push_back(object);
      SceneObject estimate =
          makeObject(static_cast<std::uint64_t>(id), object.position.x() + shift.x(),
                     object.position.y() + shift.y(), person ? kPedestrian : kCar, 1);
      estimate.yaw = object.yaw;
      estimate.length = object.length;
      estimate.width = object.width;
      estimate.velocity = {-1, 0};
      scene.objects.push_back(estimate);
    }
    run.scenes.push_back(scene);
  }
  return evaluate(run, makeGroundTruth(truth), {});
}

TEST(WholeRun, MadeOfTheTruthIsPerfect) {
  const Evaluation e = runOfTheTruth({0, 0});
  for (const Pairing pairing : {Pairing::kClosest, Pairing::kOneToOne}) {
    const TrackingFigures f = trackingFigures(e, pairing);
    EXPECT_GT(f.active, 60u);
    for (const Figure& one : {f.tracked_a, f.tracked_b, f.tracked_c, f.correct}) EXPECT_EQ(one, 1);
    for (const Figure& zero :
         {f.range_rms, f.center_range_rms, f.bearing_rms, f.position_rms, f.speed_rms,
          f.velocity_rms, f.heading_rms, f.heading_reversed, f.mis, f.unclassified}) {
      EXPECT_EQ(zero, 0);
    }
    EXPECT_EQ(f.id_switches, 0u);
    EXPECT_EQ(f.fragmentations, 0u);
    EXPECT_EQ(reliability(e, pairing).calibration_error, 0);
  }
  EXPECT_EQ(setFigures(e, 2).gospa_rms, 0);
  EXPECT_EQ(falseObjectFigures(e).per_instant, 0);
}

TEST(WholeRun, ShiftedByAMeterHasExactlyThatError) {
  const Evaluation e = runOfTheTruth({0.6, -0.8});
  const TrackingFigures f = trackingFigures(e, Pairing::kOneToOne);
  EXPECT_EQ(f.tracked_a, 1);
  EXPECT_NEAR(*f.position_rms, 1, kTiny);
  EXPECT_NEAR(*f.velocity_rms, 0, kTiny);
  EXPECT_NEAR(*f.heading_rms, 0, kTiny);
  EXPECT_LE(*f.range_rms, 1);
  EXPECT_LE(*f.center_range_rms, 1);
  const SetFigures sets = setFigures(e, 2);
  EXPECT_NEAR(*sets.localization_rms, 1, kTiny);
  EXPECT_EQ(sets.missed, 0);
  EXPECT_EQ(sets.false_, 0);
  EXPECT_NEAR(*sets.ospa_mean, 1, kTiny);
}

TEST(WholeRun, ShiftedAlongTheLineOfSightIsARangeError) {
  TruthObject truth = makeTruth(0, 1, 10, 0);
  truth.length = 4;
  truth.width = 2;
  SceneObject estimate = makeObject(1, 11, 0);
  estimate.length = 4;
  estimate.width = 2;
  const TrackingFigures along = trackingFigures(compare({{estimate}}, {truth}), Pairing::kClosest);
  EXPECT_NEAR(*along.range_rms, 1, kTiny);
  EXPECT_NEAR(*along.bearing_rms, 0, kTiny);
  estimate.position = {10, 1, 0};
  const TrackingFigures across = trackingFigures(compare({{estimate}}, {truth}), Pairing::kClosest);
  EXPECT_NEAR(*across.bearing_rms, std::atan(0.1), kTiny);
  EXPECT_NEAR(*across.range_rms, 0, kTiny);  // the near side still reaches the axis at 8 m
  EXPECT_NEAR(*across.center_range_rms, std::sqrt(101.0) - 10, kTiny);
}

}  // namespace
}  // namespace perception
