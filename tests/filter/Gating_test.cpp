#include "libperception/filter/Gating.h"

#include <gtest/gtest.h>

#include "libperception/core/Random.h"
#include "libperception/filter/Innovation.h"
#include "libperception/filter/MotionModels.h"
#include "tests/support/FilterWorld.h"

namespace perception {
namespace {

ClassFilter randomFilter(Rng& rng) {
  ClassFilter f;
  Matrix4 root;
  for (int i = 0; i < 16; ++i) root(i / 4, i % 4) = rng.normal(0, 0.5);
  f.P = root * root.transpose();
  f.x << rng.normal(0, 3), rng.normal(0, 3), rng.normal(), rng.normal();
  return f;
}

TEST(AxisBounds, ExcludeNoPairThatPassesTheGateAndMostThatDoNot) {
  Rng rng({8, 0, 0, 0});
  const PositionModel model(test::linearSensor());
  const ClassTable classes = test::linearClasses();
  const double gate = Gates::of(0.999).quantile[2];
  int outside = 0, excluded = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const ClassFilter f = randomFilter(rng);
    const Kinematics k = kinematicsOf(classes[0], f);
    AxisPrediction h;
    model.predict(&k, &f.extent, 1, {}, &h);
    Measurement m;
    m.z = Vector2(rng.normal(0, 5), rng.normal(0, 5));
    m.R = 0.01 * Matrix2::Identity();
    m.seen = 3;
    const Innovation i = innovationOf(f, k, h, m, model);
    const bool passes = i.y.dot(i.S.inverse() * i.y) <= gate;
    const bool out = AxisBounds(f, k, h).exclude(m, model.axes(), gate);
    ASSERT_FALSE(passes && out) << trial;
    outside += !passes;
    excluded += out;
  }
  EXPECT_GT(excluded, outside / 2);
}

TEST(Surroundings, HoldEveryPairThatIsCoarselyNear) {
  Rng rng({9, 0, 0, 0});
  for (int trial = 0; trial < 2000; ++trial) {
    Track t;
    for (int j = 0; j < 3; ++j) t.bank.push_back(randomFilter(rng));
    Measurement m;
    m.position = {rng.normal(0, 20), rng.normal(0, 20)};
    ASSERT_TRUE(Surroundings(t).mayBeNear(m) || !coarselyNear(t, m)) << trial;
  }
}

}  // namespace
}  // namespace perception
