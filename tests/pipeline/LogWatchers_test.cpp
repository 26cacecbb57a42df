#include "libperception/pipeline/LogWatchers.h"

#include <gtest/gtest.h>

#include <set>

namespace perception::test {
namespace {

constexpr Stamp kStart{1700000000000000000};

ClassTable cars() {
  ClassTable table;
  table.classes.resize(1);
  table.classes[0].name = "car";
  return table;
}

/// Each object is in three scenes; every second one is classified in its second one.
Scene sceneOf(std::uint64_t number) {
  Scene scene;
  scene.stamp = Stamp{kStart.ns + static_cast<std::int64_t>(number) * 100000000};
  for (std::uint64_t id = number > 2 ? number - 2 : 1; id <= number; ++id) {
    SceneObject object;
    object.id = id;
    object.classified = id % 2 == 0 && id < number;
    scene.objects.push_back(object);
  }
  return scene;
}

TEST(ObjectEvents, ForgettingTheDeadChangesNoEventAndBoundsTheirNumber) {
  const ClassTable classes = cars();
  EventLog all_events, few_events;
  ObjectEvents all(classes, all_events), few(classes, few_events);
  int forgotten = 0;
  for (std::uint64_t i = 1; i < 10 * ObjectEvents::kFewIds; ++i) {
    const Scene scene = sceneOf(i);
    all.add(scene);
    few.add(scene);
    if (!few.isFull()) continue;
    std::set<std::uint64_t> living;
    for (const auto& object : scene.objects) living.insert(object.id);
    few.keepOnly(living);
    EXPECT_FALSE(few.isFull());
    ++forgotten;
  }
  EXPECT_GE(forgotten, 8);
  EXPECT_TRUE(all.isFull());
  EXPECT_EQ(few.objects(), 10 * ObjectEvents::kFewIds - 1);
  EXPECT_EQ(few.objects(), all.objects());
  EXPECT_EQ(few_events.text(kStart), all_events.text(kStart));
}

}  // namespace
}  // namespace perception::test
