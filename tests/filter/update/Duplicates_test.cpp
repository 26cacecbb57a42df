#include "libperception/filter/update/Duplicates.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/FilterWorld.h"

namespace perception {
namespace {

const Stamp kNow = Stamp::fromSeconds(1000);

FilterModel model() {
  ClassTable table;
  ObjectClass car;
  car.name = "car";
  car.motion = findMotionModel("wheeled");
  car.prior = 1;
  car.max_speed = 50;
  table.classes = {car};
  FilterModel m = test::exactModel(std::move(table));
  m.params.merge_area = 2;
  return m;
}

/// A car at x = 10 m that was last hit `ago` seconds ago.
Track carWith(std::uint64_t id, double existence, int hits, double ago) {
  Track t;
  t.id = id;
  t.stamp = kNow;
  t.existence = existence;
  t.log_class = {0};
  t.hits[0] = hits;
  t.last_hit[0] = kNow + -ago;
  t.bank.resize(1);
  t.bank[0].x.head<2>() = Vector2(10, 0);
  t.bank[0].extent.length = 4.5;
  t.bank[0].extent.width = 1.8;
  return t;
}

/// Id of what stays of the older one and of a car that was born with id 2 and is hit now.
std::uint64_t idThatStays(const Track& older) {
  TrackTable tracks = {std::make_shared<const Track>(older),
                       std::make_shared<const Track>(carWith(2, 0.999, 3, 0))};
  const DuplicateTable duplicates(model(), kNow, tracks);
  duplicates.appendReplacements(tracks);
  const auto cells = duplicates.merged({0, 1});
  EXPECT_EQ(cells.size(), 1U);
  return tracks[cells.front()]->id;
}

TEST(Duplicates, AFalseDetectionWhereACarComesByGivesWay) {
  EXPECT_EQ(idThatStays(carWith(1, 0.2, 1, 0.5)), 2U);
}

TEST(Duplicates, AnOlderCarKeepsItsIdWhenItIsSeenAgain) {
  EXPECT_EQ(idThatStays(carWith(1, 0.9, 1, 0.5)), 1U);
  EXPECT_EQ(idThatStays(carWith(1, 0.2, 20, 0.5)), 1U) << "it was hidden";
}

TEST(Duplicates, ATrackLeftBehindStandsWhereItHasGone) {
  const FilterModel base = test::threeClassModel();
  FilterModel model = base;
  model.params.merge_area = 2;
  const Stamp now = Stamp::fromSeconds(1000.4);
  const auto car = [&](std::uint64_t id, double x, double v, double t) {
    Track track;
    track.id = id;
    track.stamp = Stamp::fromSeconds(1000 + t);
    track.bank.resize(3);
    track.bank[2].x << x, 0, v, 0;
    track.bank[2].oriented = true;
    track.bank[2].extent = {4, 2, 0.1, 0.1};
    track.log_class = {-20, -20, std::log1p(-2 * std::exp(-20.0))};
    return std::make_shared<const Track>(track);
  };
  const auto kept = [&](double v) {
    const TrackTable tracks{car(1, 0, 0, 0.4), car(2, -4, v, 0)};
    return DuplicateTable(model, now, tracks).merged({0, 1}).size();
  };
  EXPECT_EQ(kept(10), 1u);  // by now both are at 0
  EXPECT_EQ(kept(0), 2u);
}

TEST(Duplicates, ALargeTrackReplacesItsOlderFragmentAndTwoVehiclesAreOne) {
  FilterModel model = test::threeClassModel();
  model.params.merge_area = 2;
  const Stamp now = Stamp::fromSeconds(1000);
  const auto track = [&](std::uint64_t id, ClassId likeliest, double x, Extent extent,
                         bool oriented, double probability = 0.99) {
    Track t;
    t.id = id;
    t.stamp = now;
    t.last_hit.fill(now);
    t.bank.resize(3);
    ClassFilter& filter = t.bank[static_cast<std::size_t>(likeliest)];
    filter.x << x, 0, 0, 0;
    filter.oriented = oriented;
    filter.extent = extent;
    t.log_class.assign(3, std::log((1 - probability) / 2));
    t.log_class[static_cast<std::size_t>(likeliest)] = std::log(probability);
    return std::make_shared<const Track>(t);
  };
  const auto left = [&](double first, double second) {
    const TrackTable tracks{track(1, 2, 0, {4, 2, 0.1, 0.1}, true, first),
                            track(2, 2, 1, {4, 2, 0.1, 0.1}, true, second)};
    return DuplicateTable(model, now, tracks).merged({0, 1}).size();
  };
  EXPECT_EQ(left(0.6, 0.6), 1u) << "two vehicles cannot share a place";
  EXPECT_EQ(left(0.6, 0.4), 2u) << "one of them may be a hedge";
  const auto merged = [&](bool oriented) {
    TrackTable tracks{track(1, 0, 1, {0.5, 0.5, 0.1, 0.1}, false),
                      track(2, 2, 0, {4, 2, 0.1, 0.1}, oriented)};
    const DuplicateTable table(model, now, tracks);
    const auto cells = table.merged({0, 1});
    table.appendReplacements(tracks);
    return cells.size() == 1 ? tracks[cells[0]] : nullptr;
  };
  const TrackHandle car = merged(true);
  ASSERT_TRUE(car);
  EXPECT_EQ(car->id, 1u);
  EXPECT_EQ(car->likeliestClass(), 2);
  EXPECT_EQ(car->bank[2].x[0], 0);
  const TrackHandle doubtful = merged(false);
  ASSERT_TRUE(doubtful);
  EXPECT_EQ(doubtful->likeliestClass(), 0) << "a footprint without a heading may be a hedge";
}

TEST(Duplicates, APersonWhomACarIsPutOverDoesNotBecomeTheCar) {
  FilterModel model = test::threeClassModel();
  model.params.merge_area = 2;
  const auto stay = [&](ObjectShape shape, double unseen) {
    model.classes.classes[0].shape = shape;
    Track small = carWith(1, 0.999, 20, unseen), car = carWith(2, 0.999, 3, 0);
    for (Track* t : {&small, &car}) {
      const Extent extent = t == &car ? Extent{4, 2, 0.1, 0.1} : Extent{0.5, 0.5, 0.1, 0.1};
      const std::size_t likeliest = t == &car ? 2 : 0;
      t->bank.assign(3, t->bank[0]);
      t->bank[likeliest].extent = extent;
      t->bank[2].oriented = t == &car;
      t->log_class.assign(3, std::log(0.005));
      t->log_class[likeliest] = std::log(0.99);
    }
    TrackTable tracks = {std::make_shared<const Track>(small), std::make_shared<const Track>(car)};
    const DuplicateTable duplicates(model, kNow, tracks);
    duplicates.appendReplacements(tracks);
    TrackTable kept;
    for (const auto cell : duplicates.merged({0, 1})) kept.push_back(tracks[cell]);
    return kept;
  };
  const auto seen = stay(ObjectShape::kPedestrian, 0);
  ASSERT_EQ(seen.size(), 1U);
  EXPECT_EQ(seen[0]->id, 1U);
  EXPECT_EQ(seen[0]->likeliestClass(), 0);
  EXPECT_EQ(stay(ObjectShape::kThing, 0)[0]->likeliestClass(), 2) << "a fragment of it";
  EXPECT_EQ(stay(ObjectShape::kCyclist, 0.5).size(), 2U) << "hidden behind it";
}

TEST(Duplicates, ACyclistAsLongAsACarIsReplacedByTheCarInItsPlace) {
  FilterModel model = test::threeClassModel();
  model.params.merge_area = 2;
  ObjectClass& cyclist = model.classes.classes[0];
  cyclist.shape = ObjectShape::kCyclist;
  cyclist.length = 1.8, cyclist.length_sigma = 0.2;
  const auto stays = [&](double length, double car_probability) {
    Track older = carWith(1, 0.999, 20, 0), car = carWith(2, 0.999, 3, 0);
    for (Track* t : {&older, &car}) {
      const std::size_t likeliest = t == &car ? 2 : 0;
      const double probability = t == &car ? car_probability : 0.99;
      t->bank.assign(3, t->bank[0]);
      t->bank[0].extent = {length, 0.9, 0.1, 0.1};
      t->bank[likeliest].oriented = true;
      t->log_class.assign(3, std::log((1 - probability) / 2));
      t->log_class[likeliest] = std::log(probability);
    }
    TrackTable tracks = {std::make_shared<const Track>(older), std::make_shared<const Track>(car)};
    const DuplicateTable duplicates(model, kNow, tracks);
    duplicates.appendReplacements(tracks);
    const auto cells = duplicates.merged({0, 1});
    EXPECT_EQ(cells.size(), 1U);
    EXPECT_EQ(tracks[cells.front()]->id, 1U);
    return tracks[cells.front()]->likeliestClass();
  };
  EXPECT_EQ(stays(5.2, 0.99), 2);
  EXPECT_EQ(stays(2.5, 0.99), 0) << "a cyclist of this length may be";
  EXPECT_EQ(stays(5.2, 0.8), 0) << "the car is not sure";
}

TEST(Duplicates, AClassGoesWithWhatHasBeenCountedInIt) {
  Track older = carWith(1, 0.999, 20, 0.5), younger = carWith(2, 0.999, 3, 0);
  older.length = {4.5, 0.1}, younger.length = {2, 1};
  older.fitting_length = {4.4, 0.1}, younger.fitting_length = {2, 1};
  older.fitting_width = {1.7, 0.1}, younger.fitting_width = {2.4, 1};
  older.longest = 4.6, younger.longest = 2;
  older.evidence.push_back({7, kNow, {}, 3, 20, {}});
  TrackTable tracks = {std::make_shared<const Track>(older),
                       std::make_shared<const Track>(younger)};
  const DuplicateTable duplicates(model(), kNow, tracks);
  duplicates.appendReplacements(tracks);
  const auto cells = duplicates.merged({0, 1});
  ASSERT_EQ(cells.size(), 1U);
  const Track& kept = *tracks[cells.front()];
  EXPECT_EQ(kept.last_hit[0], kNow) << "the state of the younger one";
  EXPECT_EQ(kept.length.mean, 4.5);
  EXPECT_EQ(kept.fitting_length.mean, 4.4);
  EXPECT_EQ(kept.fitting_width.mean, 1.7);
  EXPECT_EQ(kept.longest, 4.6);
  ASSERT_EQ(kept.evidence.size(), 1U);
  EXPECT_EQ(kept.evidence[0].views, 3);
}

/// A car that drives along x with its middle at `x` [m].
Track driving(std::uint64_t id, double x, double y, double speed) {
  Track t = carWith(id, 0.999, 10, 0);
  t.bank[0].x << x, y, speed, 0;
  t.bank[0].P.diagonal() << 0.1, 0.1, 0.04, 0.001;
  t.bank[0].oriented = true;
  return t;
}

std::size_t tracksThatStay(const Track& a, const Track& b) {
  const TrackTable tracks = {std::make_shared<const Track>(a), std::make_shared<const Track>(b)};
  return DuplicateTable(model(), kNow, tracks).merged({0, 1}).size();
}

TEST(Duplicates, TwoPartsThatDriveABumperApartAreOneVehicle) {
  EXPECT_EQ(tracksThatStay(driving(1, 10, 0, 25), driving(2, 15.5, 0.3, 25.4)), 1U);
}

TEST(Duplicates, ANewbornOnTheLineOfAVehicleIsAPartOfItAlthoughItsHeadingErrs) {
  Track newborn = driving(2, 15.5, 0.3, 25);
  newborn.bank[0].x[3] = 0.16;  // 4 m/s across
  EXPECT_EQ(tracksThatStay(driving(1, 10, 0, 25), newborn), 2U) << "the heading is known";
  newborn.bank[0].P(3, 3) = 0.04;
  EXPECT_EQ(tracksThatStay(driving(1, 10, 0, 25), newborn), 1U);
  newborn.bank[0].x[2] = 22;
  EXPECT_EQ(tracksThatStay(driving(1, 10, 0, 25), newborn), 2U) << "it is slower";
}

TEST(Duplicates, VehiclesThatFollowEachOtherAreTwo) {
  EXPECT_EQ(tracksThatStay(driving(1, 10, 0, 25), driving(2, 20, 0, 25)), 2U) << "0.2 s behind";
  EXPECT_EQ(tracksThatStay(driving(1, 10, 0, 3), driving(2, 15, 0, 3)), 2U) << "in a queue";
}

TEST(Duplicates, SlowVehiclesWhoseFootprintsOverlapAreOneAndStandingOnesAreTwo) {
  EXPECT_EQ(tracksThatStay(driving(1, 10, 0, 3), driving(2, 13.8, 0.3, 3.3)), 1U);
  EXPECT_EQ(tracksThatStay(driving(1, 10, 0, 3), driving(2, 14.1, 0.3, 3.3)), 2U) << "by 0.4 m";
  EXPECT_EQ(tracksThatStay(driving(1, 10, 0, 3), driving(2, 13.8, 0.3, 5)), 2U) << "one is faster";
  EXPECT_EQ(tracksThatStay(driving(1, 10, 0, 0.1), driving(2, 13.8, 0.3, 0.1)), 2U)
      << "parked cars of which too long ones are seen";
}

TEST(Duplicates, VehiclesBesideEachOtherOrOfOtherSpeedsAreTwo) {
  EXPECT_EQ(tracksThatStay(driving(1, 10, 0, 25), driving(2, 12, 2.8, 25)), 2U);
  EXPECT_EQ(tracksThatStay(driving(1, 10, 0, 25), driving(2, 15.5, 0, 20)), 2U);
}

}  // namespace
}  // namespace perception
