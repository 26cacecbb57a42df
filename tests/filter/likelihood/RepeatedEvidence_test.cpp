#include "libperception/filter/likelihood/RepeatedEvidence.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/core/math/Random.h"
#include "tests/filter/likelihood/RememberingSensor.h"

namespace perception {
namespace {

using test::kAhead;
using test::odds;
using test::RepeatFixture;
using test::Repeats;

/// What a view adds; remembers it.
double add(Track& track, const MeasurementScan& scan, std::size_t j = 0) {
  const Look look = lookOf(track, scan.measurements[0], scan, {}).value();
  const double added = RepeatedEvidence(track, look, scan).added(j);
  rememberEvidence(look, scan, track);
  return added;
}

TEST(Track, CountsTheLooksThatShouldHaveShownWhatASensorToldByItsShape) {
  RepeatFixture f;
  Track track = f.hit(f.born(f.seen(0, kAhead)), f.seen(0.1, kAhead));
  EXPECT_EQ(track.missed, 0);
  EXPECT_EQ(track.shareOfEvidence(), 1);
  MeasurementScan empty = f.seen(0.2, kAhead);
  empty.measurements.clear();
  const auto miss = [&](const MeasurementScan& scan) {
    track = predictTrack(track, scan.state.stamp, f.model);
    const auto table = likelihoodTable({track}, scan, f.model);
    track = missTrack(track, table.tracks[0], scan, f.model);
    return table.tracks[0].detection;
  };
  const double detection = miss(empty);
  EXPECT_GT(detection, 0.1);
  EXPECT_NEAR(track.missed, detection, 1e-12);
  EXPECT_NEAR(track.shareOfEvidence(), 3 / (3 + detection), 1e-12);
  EXPECT_EQ(f.hit(track, f.seen(0.3, kAhead)).missed, 0) << "it is there again";
  f.repeats = Repeats::kNothing;  // a sensor that tells no shapes
  MeasurementScan other = f.seen(0.3, {});
  other.measurements.clear();
  miss(other);
  EXPECT_NEAR(track.missed, detection, 1e-12);
}

TEST(RepeatedEvidence, TheFirstViewCountsFully) {
  const RepeatFixture f;
  Track track;
  const auto scan = f.seen(0, kAhead);
  const RepeatedEvidence evidence(track, *lookOf(track, scan.measurements[0], scan, {}), scan);
  EXPECT_EQ(evidence.added(0), 1.5);
  EXPECT_EQ(evidence.added(1), -0.5);
  EXPECT_EQ(evidence.views(), 1);
  add(track, scan);
  ASSERT_EQ(track.evidence.size(), 1u);
  EXPECT_EQ(track.evidence[0].mean, (std::vector<double>{1.5, -0.5}));
  EXPECT_EQ(track.evidence[0].views, 1);
  EXPECT_EQ(track.evidence[0].stamp.ns, scan.state.stamp.ns);
}

TEST(RepeatedEvidence, AViewAlikeIsWorthLittle) {
  const RepeatFixture f;
  Track track;
  add(track, f.seen(0, kAhead));
  const double second = add(track, f.seen(0, kAhead));
  EXPECT_NEAR(second, 1.5 * (f.memory.looks(1 + 0.1 / 1.9) - 1), 1e-12);
}

TEST(RepeatedEvidence, ViewsAlikeAreWorthNoMoreThanWhatStaysAllows) {
  RepeatFixture f;
  f.memory.kept = 0;  // each view is independent but for what stays
  Track track;
  double sum = 0;
  for (int k = 0; k < 10; ++k) sum += add(track, f.seen(k, kAhead));
  EXPECT_NEAR(sum, 1.5 * 10 / (1 + 0.2 * 9), 1e-9);
  for (int k = 10; k < 3000; ++k) sum += add(track, f.seen(k, kAhead));
  EXPECT_LT(sum, 1.5 / 0.2);
  EXPECT_GT(sum, 1.5 / 0.2 - 0.01);
}

TEST(RepeatedEvidence, TheSumOfAllAddedIsThatOfTheMean) {
  const RepeatFixture f;
  Rng rng(RngKey{4, 0, 0, 11});
  for (std::size_t j = 0; j < 2; ++j) {
    Track track;
    double sum = 0, t = 0;
    EvidenceView view = kAhead;
    for (int k = 0; k < 40; ++k) {
      t += rng.uniform(0, 0.3);
      view.bearing += rng.normal(0, 0.2), view.log_range += rng.normal(0, 0.1);
      sum += add(track, f.seen(t, view, {rng.normal(1, 2), rng.normal(-1, 2)}), j);
      const EvidenceSeen& seen = track.evidence.at(0);
      ASSERT_NEAR(sum, f.memory.looks(seen.views) * seen.mean[j], 1e-9);
    }
  }
}

TEST(RepeatedEvidence, AViewFromElsewhereLetsTheOldOnesGo) {
  const RepeatFixture f;
  Track track;
  double sum = 0;
  for (int k = 0; k < 20; ++k) sum += add(track, f.seen(0.1 * k, kAhead, {4, 0}));
  const auto other = f.seen(2, EvidenceView{kAhead.bearing + 3, kAhead.log_range}, {-1, 0});
  sum += add(track, other);
  EXPECT_NEAR(sum, -1, 0.05);
  EXPECT_NEAR(track.evidence[0].views, 1, 0.01);
}

TEST(RepeatedEvidence, AViewOfManyReturnsWeighsMore) {
  const RepeatFixture f;
  const auto judged = [&](double whole, double corner) {
    Track track;
    double sum = add(track, f.seen(0, EvidenceView{0.1, 3, whole}, {3, 0}));
    for (int k = 1; k <= 20; ++k)
      sum += add(track, f.seen(0.1 * k, EvidenceView{0.1, 3, corner}, {-1, 0}));
    return sum;
  };
  EXPECT_LT(judged(20, 20), 1.5);
  EXPECT_GT(judged(400, 20), 3) << "the side that was seen is not forgotten behind the corner";
  EXPECT_NEAR(judged(7, 7), judged(20, 20), 1e-9) << "only the proportion of the returns counts";
}

TEST(RepeatedEvidence, AnObjectThatComesNearIsJudgedAnew) {
  const RepeatFixture f;
  Track track;
  double sum = 0;
  for (int k = 0; k < 20; ++k)
    sum += add(track, f.seen(0.1 * k, EvidenceView{0.1, std::log(60.0)}, {4, 0}));
  sum += add(track, f.seen(2, EvidenceView{0.1, std::log(4.0)}, {-1, 0}));
  EXPECT_LT(sum, -0.5);
}

TEST(RepeatedEvidence, EachSensorHasAMemoryOfItsOwn) {
  const RepeatFixture f;
  Track track;
  MeasurementScan left = f.seen(0, kAhead), right = f.seen(0, kAhead);
  right.sensor = "RIGHT";
  EXPECT_EQ(add(track, left), 1.5);
  EXPECT_EQ(add(track, right), 1.5);
  EXPECT_EQ(track.evidence.size(), 2u);
  EXPECT_LT(add(track, left), 0.2);
  EXPECT_EQ(track.evidence.size(), 2u);
}

TEST(RepeatedEvidence, WithoutAViewOrAMemoryNothingIsKept) {
  RepeatFixture f;
  Track track;
  const auto check = [&](const MeasurementScan& scan) {
    EXPECT_FALSE(lookOf(track, scan.measurements[0], scan, {}));
  };
  check(f.seen(0, std::nullopt));
  f.repeats = Repeats::kNothing;
  check(f.seen(0, kAhead));
}

/// The first class is a vehicle; a scan of clear air in which a shape of so many returns says
/// `said`.
struct VehicleInClearAir : RepeatFixture {
  VehicleInClearAir() { model.classes.classes[0].shape = ObjectShape::kVehicle; }
  MeasurementScan of(double returns, std::vector<double> said) const {
    MeasurementScan scan = seen(0, EvidenceView{0.1, 3, returns}, std::move(said));
    scan.verdicts.emplace();
    return scan;
  }
  /// Of a track that was born from the same.
  ClassValues weighed(const MeasurementScan& scan) const { return weighed(scan, born(scan)); }
  ClassValues weighed(const MeasurementScan& scan, const Track& track) const {
    return weighedLookOf(track, scan.measurements[0], scan, {}, model.classes)->said;
  }
};

TEST(RepeatedEvidence, AShapeOfManyReturnsTellsVehiclesStrongerThanItsModelSays) {
  const VehicleInClearAir f;
  const ClassValues vehicle = f.weighed(f.of(100, {1.5, -0.5}));
  EXPECT_NEAR(vehicle[0], 1.5 * 1.3 * 100 / 115, 1e-12);
  EXPECT_EQ(vehicle[1], -0.5);
  EXPECT_EQ(f.weighed(f.of(10, {1.5, -0.5}))[0], 1.5) << "few returns say what they say";
  EXPECT_EQ(f.weighed(f.of(100, {-1.5, 0.5}))[0], -1.5) << "so does what speaks against it";
  EXPECT_EQ(f.weighed(f.of(100, {-1.5, 0.5}))[1], 0.5) << "so does what speaks for a thing";
}

TEST(RepeatedEvidence, AmongPhantomsAndByOtherSensorsVehiclesAreNotStronger) {
  const VehicleInClearAir f;
  MeasurementScan scan = f.of(100, {1.5, -0.5});
  scan.verdicts->suspicious = 1;
  EXPECT_EQ(f.weighed(scan)[0], 1.5);
  scan.verdicts->suspicious = 0, scan.verdicts->phantoms.emplace_back();
  EXPECT_EQ(f.weighed(scan)[0], 1.5);
  scan.verdicts.reset();
  EXPECT_EQ(f.weighed(scan)[0], 1.5);
}

TEST(RepeatedEvidence, ABirthTellsAVehicleAsItsModelSaysAndEachHitStronger) {
  const VehicleInClearAir f;
  const MeasurementScan scan = f.of(100, {1.5, -0.5});
  EXPECT_EQ(f.weighed(scan, Track{})[0], 1.5);
  Track track = f.born(scan);
  EXPECT_NEAR(odds(track), std::log(0.6 / 0.4) + 2, 1e-9);
  MeasurementScan later = f.of(100, {1.5, -0.5});
  later.state.stamp = later.state.stamp + 0.1;
  track = f.hit(track, later);
  const EvidenceSeen& seen = track.evidence.at(0);
  EXPECT_GT(seen.mean[0], 1.5);
  EXPECT_LT(seen.mean[0], 1.5 * 1.3 * 100 / 115) << "the mean of both looks";
  EXPECT_NEAR(odds(track), std::log(0.6 / 0.4) + (seen.mean[0] + 0.5) * f.memory.looks(seen.views),
              1e-6);
}

TEST(RepeatedEvidence, AShapeOfFewReturnsTellsPedestriansWeaker) {
  VehicleInClearAir f;
  f.model.classes.classes[0].shape = ObjectShape::kPedestrian;
  EXPECT_EQ(f.weighed(f.of(20, {1.5, -0.5}))[0], 1.5) << "of a model that knows no posts";
  f.memory.few_of_pedestrian = 25;
  MeasurementScan scan = f.of(20, {1.5, -0.5});
  const double said = 1.5 * 1.2 * 20 / 45;
  EXPECT_NEAR(f.weighed(scan)[0], said, 1e-12);
  EXPECT_NEAR(odds(f.born(scan)), std::log(0.6 / 0.4) + said + 0.5, 1e-9) << "a birth alike";
  scan.verdicts->suspicious = 1;
  EXPECT_NEAR(f.weighed(scan)[0], said, 1e-12) << "so among phantoms";
  EXPECT_EQ(f.weighed(f.of(125, {1.5, -0.5}))[0], 1.5);
  EXPECT_EQ(f.weighed(f.of(500, {1.5, -0.5}))[0], 1.5);
  EXPECT_EQ(f.weighed(f.of(20, {-1.5, 0.5}))[0], -1.5) << "what speaks against it counts in full";
}

TEST(RepeatedEvidence, WhatSurelyWalksIsNoPost) {
  VehicleInClearAir f;
  f.model.classes.classes[0].shape = ObjectShape::kPedestrian;
  f.memory.few_of_pedestrian = 25;
  const MeasurementScan scan = f.of(20, {1.5, -0.5});
  const double said = 1.5 * 1.2 * 20 / 45;
  const auto at = [&](double vx, double vy, double sigma) {
    Track track = f.born(scan);
    track.bank[0].x.tail<2>() = Vector2(vx, vy);
    track.bank[0].P.bottomRightCorner<2, 2>() = sigma * sigma * Matrix2::Identity();
    return f.weighed(scan, track)[0];
  };
  EXPECT_EQ(at(0.3, -0.4, 0.01), said) << "views of a post change by as much";
  EXPECT_NEAR(at(0.9, -1.2, 0.1), 1.5, 1e-9) << "a walk of 1.5 m/s, by ten deviations";
  const double half = at(0, 1, 0.5);
  EXPECT_NEAR(half, said + (1.5 - said) * std::erf(1 / std::sqrt(2)), 1e-12);
  EXPECT_LT(at(0, 1, 1), half);
  EXPECT_GT(at(0, 1, 1), said);
}

// In the update ---------------------------------------------------------------------------------

TEST(RepeatedEvidence, IdenticalEvidenceConverges) {
  const RepeatFixture f;
  const double prior = std::log(0.6 / 0.4);
  Track track = f.born(f.seen(0, kAhead));
  EXPECT_NEAR(odds(track), prior + 2, 1e-9) << "a birth is the first view";
  double before = odds(track);
  for (int k = 1; k <= 300; ++k) {
    track = f.hit(track, f.seen(0.1 * k, kAhead));
    EXPECT_GE(odds(track), before);
    before = odds(track);
    ASSERT_NEAR(odds(track), prior + 2 * f.memory.looks(track.evidence.at(0).views), 1e-6) << k;
  }
  EXPECT_LT(odds(track), prior + 2 / 0.2);
  EXPECT_GT(odds(track), prior + 0.8 * 2 / 0.2);
}

TEST(RepeatedEvidence, IndependentEvidenceGrowsAsBefore) {
  RepeatFixture f;
  const double prior = std::log(0.6 / 0.4);
  const auto after = [&](const std::optional<EvidenceView>& view) {
    Track track = f.born(f.seen(0, view));
    for (int k = 1; k <= 5; ++k) track = f.hit(track, f.seen(0.1 * k, view));
    return odds(track);
  };
  EXPECT_NEAR(after(std::nullopt), prior + 6 * 2, 1e-9);
  f.repeats = Repeats::kNothing;
  EXPECT_NEAR(after(kAhead), prior + 6 * 2, 1e-9);
}

TEST(RepeatedEvidence, AHitMayTakeBackWhatWasSaidBefore) {
  const RepeatFixture f;
  Track track = f.born(f.seen(0, kAhead, {3, 0}));
  const double before = odds(track);
  track = f.hit(track, f.seen(0.1, EvidenceView{kAhead.bearing + 3, 3}, {0, 0}));
  EXPECT_NEAR(odds(track), before - 3, 0.05);
}

}  // namespace
}  // namespace perception
