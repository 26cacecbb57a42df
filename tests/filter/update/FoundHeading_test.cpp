#include <gtest/gtest.h>

#include <cmath>

#include "libperception/filter/predict/Prediction.h"
#include "libperception/filter/update/Update.h"
#include "tests/support/FilterWorld.h"

namespace perception {
namespace {

/// The car's filter after the scan in which a motion of 10 m/s along x tells its heading. Before it
/// was a disc that had shrunk to the width of its rear.
ClassFilter carAfterItsHeading(bool by_shape) {
  FilterModel model = test::exactModel(test::linearClasses());
  ObjectClass& car = model.classes.classes[0];
  car.motion = findMotionModel("wheeled");
  car.max_speed = 50, car.length = 4.5, car.width = 1.8;
  const auto sensor = std::make_shared<const PositionModel>(test::linearSensor());
  const auto first = test::positionScan(sensor, 0, {{10, 0, 0}});
  Track t = newTrack(likelihoodTable({}, first, model).births[0], 0, first, 0, model);
  t.bank[0].extent = {2.2, 1.6, 0.01, 0.01};
  auto scan = test::positionScan(sensor, 0.5, {{15, 0, 0}});
  if (by_shape) scan.measurements[0].view.emplace();
  t = predictTrack(t, scan.state.stamp, model);
  const auto table = likelihoodTable({t}, scan, model);
  return hitTrack(t, table.tracks[0], table.tracks[0].pairs.at(0), scan, 1, model).bank[0];
}

TEST(FoundHeading, GivesBackTheSizeThatADiscHasLost) {
  const ClassFilter before = carAfterItsHeading(false), f = carAfterItsHeading(true);
  ASSERT_TRUE(before.oriented && f.oriented);
  EXPECT_NEAR(f.extent.length, 4.5, 1e-9);
  EXPECT_NEAR(f.extent.width, 1.8, 1e-9);
  EXPECT_GT(f.extent.var_length, 0.1) << "its length has not been seen";
  EXPECT_NEAR(f.x[0] - 4.5 / 2, before.x[0] - (2.2 + 1.6) / 4, 1e-9) << "its rear stays";
  EXPECT_LT(before.extent.length, 2.5) << "where no cluster is told by its shape";
}

}  // namespace
}  // namespace perception
