#include "libperception/pipeline/phantoms/PersistentPlaces.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace perception {
namespace {

using Places = std::vector<Vector3>;

/// Returns 0.1 m apart on an upright surface of 0.6 m.
Places surfaceAt(double x, double y) {
  Places places;
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 6; ++column)
      places.emplace_back(x, y + 0.1 * column, 0.5 + 0.1 * row);
  return places;
}

auto count(const std::vector<char>& again) { return std::count(again.begin(), again.end(), 1); }

TEST(PersistentPlaces, WhatIsThereAgainPersists) {
  PersistentPlaces places;
  EXPECT_EQ(count(places.add(surfaceAt(20, 0))), 0);
  EXPECT_GT(count(places.add(surfaceAt(20.05, -0.05))), 30)
      << "but for a pose that is a little off";
}

TEST(PersistentPlaces, WhatIsElsewhereDoesNot) {
  PersistentPlaces places;
  places.add(surfaceAt(20, 0));
  EXPECT_EQ(count(places.add(surfaceAt(22, 0))), 0);
  EXPECT_EQ(count(places.add(surfaceAt(20, 0))), 0) << "two scans ago";
}

TEST(PersistentPlaces, ASingleReturnIsNoSurface) {
  PersistentPlaces places;
  const Places flakes = {{20, 0, 1}, {24, 1, 2}};
  places.add(flakes);
  EXPECT_EQ(count(places.add(flakes)), 0);
}

TEST(PersistentPlaces, NothingIsKnownAfterARestart) {
  PersistentPlaces places;
  places.add(surfaceAt(20, 0));
  places.clear();
  EXPECT_EQ(count(places.add(surfaceAt(20, 0))), 0);
}

}  // namespace
}  // namespace perception
