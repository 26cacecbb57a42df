#include "libperception/filter/update/Duplicates.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace perception
