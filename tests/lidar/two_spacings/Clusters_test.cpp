#include "libperception/lidar/two_spacings/Clusters.h"

#include <gtest/gtest.h>

namespace perception {
namespace {

/// Obstacle returns made by hand.
struct HandMadeReturns {
  std::vector<float> x, y, height;
  /// A row of `count` returns from (x0, y0) along x, `pitch` [m] apart, the last one at `top` [m].
  HandMadeReturns& row(float x0, float y0, int count, float pitch, float top) {
    for (int i = 0; i < count; ++i) {
      x.push_back(x0 + static_cast<float>(i) * pitch), y.push_back(y0);
      height.push_back(i + 1 == count ? top : 0.6f);
    }
    return *this;
  }
  std::vector<Cluster> find(ClusterParams params = {}) const {
    return findClusters(x, y, height, params);
  }
};

ClusterParams paperOnly() {
  ClusterParams params;
  params.accept_unstable = false;
  return params;
}

TEST(Clusters, AnIsolatedCarIsStable) {
  const auto clusters = HandMadeReturns().row(10, 0, 10, 0.4f, 1.4f).find(paperOnly());
  ASSERT_EQ(clusters.size(), 1u);
  EXPECT_TRUE(clusters[0].stable);
  EXPECT_EQ(clusters[0].points.size(), 10u);
  EXPECT_NEAR(clusters[0].centroid.x(), 11.8, 1e-5);
  EXPECT_FLOAT_EQ(clusters[0].highest, 1.4f);
}

TEST(Clusters, ANeighborWithinTheFarThresholdMakesBothUnstable) {
  const HandMadeReturns two =
      HandMadeReturns().row(10, 0, 10, 0.4f, 1.4f).row(10, 0.8f, 10, 0.4f, 1.4f);
  EXPECT_TRUE(two.find(paperOnly()).empty());
  const auto clusters = two.find();
  ASSERT_EQ(clusters.size(), 2u);
  EXPECT_FALSE(clusters[0].stable || clusters[1].stable);
  EXPECT_EQ(HandMadeReturns()
                .row(10, 0, 10, 0.4f, 1.4f)
                .row(10, 1.01f, 10, 0.4f, 1.4f)
                .find(paperOnly())
                .size(),
            2u);
}

TEST(Clusters, NeedSevenReturns) {
  EXPECT_EQ(HandMadeReturns().row(10, 0, 6, 0.4f, 1.4f).find(paperOnly()).size(), 0u);
  EXPECT_EQ(HandMadeReturns().row(10, 0, 7, 0.4f, 1.4f).find(paperOnly()).size(), 1u);
}

TEST(Clusters, NeedOneReturnAboveOneMeter) {
  EXPECT_EQ(HandMadeReturns().row(10, 0, 10, 0.4f, 1.0f).find(paperOnly()).size(), 0u);
  EXPECT_EQ(HandMadeReturns().row(10, 0, 10, 0.4f, 1.01f).find(paperOnly()).size(), 1u);
}

TEST(Clusters, AreShorterThanABus) {
  EXPECT_EQ(HandMadeReturns().row(10, 0, 37, 0.4f, 1.4f).find(paperOnly()).size(), 1u);  // 14.4 m
  EXPECT_EQ(HandMadeReturns().row(10, 0, 40, 0.4f, 1.4f).find(paperOnly()).size(), 0u);  // 15.6 m
}

TEST(Clusters, LeavePersonSizedGroupsAlone) {
  EXPECT_EQ(HandMadeReturns().row(10, 0, 10, 0.1f, 1.7f).find().size(), 0u);  // 0.9 m
  EXPECT_EQ(HandMadeReturns().row(10, 0, 14, 0.1f, 1.7f).find().size(), 1u);  // 1.3 m
}

TEST(Clusters, WeightsCountAsReturns) {
  const HandMadeReturns car = HandMadeReturns().row(10, 0, 10, 0.4f, 1.4f);
  const auto find = [&car](float weight) {
    return findClusters(car.x, car.y, car.height, {}, std::vector<float>(10, weight)).size();
  };
  EXPECT_EQ(find(0.7f), 1u);  // seven returns
  EXPECT_EQ(find(0.69f), 0u);
}

/// A car whose side rises from 0.6 to 1.4 m, and a branch across it, 1.1 m higher than what is
/// below.
HandMadeReturns carBelowBranch() {
  HandMadeReturns returns = HandMadeReturns().row(10, 0, 11, 0.4f, 1.4f);
  for (std::size_t i = 0; i < 11; ++i) returns.height[i] = 0.6f + 0.08f * static_cast<float>(i);
  for (int i = 0; i < 12; ++i) {
    returns.x.push_back(12), returns.y.push_back(static_cast<float>(i) * 0.4f);
    returns.height.push_back(2.11f);
  }
  return returns;
}

TEST(Clusters, SeenFromAboveABranchOverACarIsPartOfIt) {
  const auto clusters = carBelowBranch().find();
  ASSERT_EQ(clusters.size(), 1u);
  EXPECT_EQ(clusters[0].points.size(), 23u);
}

TEST(Clusters, NoReturnsNoClusters) { EXPECT_TRUE(HandMadeReturns().find().empty()); }

}  // namespace
}  // namespace perception
