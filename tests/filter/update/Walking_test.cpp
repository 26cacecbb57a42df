#include <gtest/gtest.h>

#include <cmath>

#include "libperception/core/math/Angle.h"
#include "libperception/filter/predict/Prediction.h"
#include "libperception/filter/update/Update.h"
#include "tests/support/FilterWorld.h"

namespace perception {
namespace {

/// Facing of a track that is first seen to face north and then goes at `speed` [m/s] north for 3 s.
double facingOf(double speed) {
  const FilterModel model = test::exactModel(test::linearClasses());
  const auto sensor = std::make_shared<const PositionModel>(test::linearSensor());
  auto first = test::positionScan(sensor, 0, {{1, 2, 0}});
  first.measurements[0].heading = MeasuredHeading{kPi / 2};
  Track t = newTrack(likelihoodTable({}, first, model).births[0], 0, first, 0, model);
  for (int k = 1; k <= 30; ++k) {
    const auto scan = test::positionScan(sensor, 0.1 * k, {{1, 2 + 0.1 * k * speed, 0}});
    t = predictTrack(t, scan.state.stamp, model);
    const auto table = likelihoodTable({t}, scan, model);
    t = hitTrack(t, table.tracks[0], table.tracks[0].pairs.at(0), scan,
                 static_cast<std::uint64_t>(k), model);
  }
  return t.body_heading->mean;
}

TEST(Walking, TurnsAReversedHeadingOfAPerson) {
  EXPECT_NEAR(facingOf(1.4), kPi / 2, 1e-9);
  EXPECT_NEAR(facingOf(-1.4), -kPi / 2, 1e-9);
  EXPECT_NEAR(facingOf(0), kPi / 2, 1e-9);
}

}  // namespace
}  // namespace perception
