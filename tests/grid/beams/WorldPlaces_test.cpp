#include "libperception/grid/beams/WorldPlaces.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <vector>

#include "libperception/grid/beams/GridPoints.h"

namespace perception {
namespace {

struct EgoPlaces {
  std::vector<float> x = {1.5F, -20.25F, 0.1F, 7}, y = {3, 0, -0.3F, 8}, z = {-1, 2.75F, 0, 9};
};

TEST(WorldPlaces, AreThoseOfThePose) {
  const EgoPlaces ego;
  const Pose3 pose = makePose(500000, -4e6, 12, 1.1, 0.05, -0.02);
  WorldPlaces places;
  places.place(pose, ego.x.data(), ego.y.data(), ego.z.data(), 4);
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector3 p(static_cast<double>(ego.x[i]), static_cast<double>(ego.y[i]),
                    static_cast<double>(ego.z[i]));
    EXPECT_NEAR((places.at(i) - pose * p).norm(), 0, 2e-9);
  }
}

TEST(WorldPlaces, ArePointsOfTheGridAsIfAppendedOneByOne) {
  EgoPlaces ego;
  ego.x[0] = std::numeric_limits<float>::quiet_NaN();  // no base
  WorldPlaces places;
  places.place(makePose(812.3, 45.6, 0, 0.7, 0, 0), ego.x.data(), ego.y.data(), ego.z.data(), 4);
  const std::vector<std::uint32_t> chosen = {0, 1, 3};
  GridPoints together, one_by_one;
  for (int round = 0; round < 2; ++round) {
    together.append(places, chosen.data(), chosen.size());
    for (const std::uint32_t k : chosen) one_by_one.push_back(places.at(k));
  }
  ASSERT_EQ(together.size(), 6U);
  EXPECT_EQ(together.base(), one_by_one.base());
  for (const std::size_t i : {1, 2, 4, 5}) EXPECT_EQ(together[i], one_by_one[i]);
}

}  // namespace
}  // namespace perception
