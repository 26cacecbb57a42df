#include <gtest/gtest.h>

#include "libperception/filter/predict/Prediction.h"
#include "libperception/filter/update/Update.h"
#include "tests/support/FilterWorld.h"

namespace perception {
namespace {

/// Log-odds of a car against a thing that never moves, both seen alike, after `scans` of 0.1 s.
double carOdds(ObjectShape shape, double speed, int scans, bool by_shape = true) {
  FilterModel model = test::exactModel(test::linearClasses());
  ObjectClass& car = model.classes.classes[0];
  car.shape = shape;
  car.max_speed = 50;
  model.params.kinematic_exponent = 0.05;
  auto params = test::linearSensor();
  params.classes[1] = params.classes[0];
  const auto sensor = std::make_shared<const PositionModel>(params);
  const auto first = test::positionScan(sensor, 0, {{1, 2, 0}});
  Track t = newTrack(likelihoodTable({}, first, model).births[0], 0, first, 0, model);
  for (int k = 1; k <= scans; ++k) {
    auto scan = test::positionScan(sensor, 0.1 * k, {{1 + 0.1 * k * speed, 2, 0}});
    if (by_shape) scan.measurements[0].view.emplace();
    t = predictTrack(t, scan.state.stamp, model);
    const auto table = likelihoodTable({t}, scan, model);
    t = hitTrack(t, table.tracks[0], table.tracks[0].pairs.at(0), scan,
                 static_cast<std::uint64_t>(k), model);
  }
  return t.log_class[0] - t.log_class[1];
}

TEST(Standing, ACarThatStandsBecomesNoThing) {
  const double first = carOdds(ObjectShape::kVehicle, 0, 1);
  const double later = carOdds(ObjectShape::kVehicle, 0, 200);
  EXPECT_GT(later, first - 0.2);
  EXPECT_LT(carOdds(ObjectShape::kThing, 0, 200), first - 1.5) << "what does not stand does";
  EXPECT_EQ(carOdds(ObjectShape::kVehicle, 0, 0), carOdds(ObjectShape::kThing, 0, 0));
}

TEST(Standing, WithoutAShapeTheInnovationsCountInFull) {
  EXPECT_LT(carOdds(ObjectShape::kVehicle, 0, 200, false),
            carOdds(ObjectShape::kVehicle, 0, 200) - 1);
}

TEST(Standing, ACarThatMovesIsNoThing) {
  EXPECT_GT(carOdds(ObjectShape::kVehicle, 2, 50), carOdds(ObjectShape::kVehicle, 0, 50) + 1);
}

}  // namespace
}  // namespace perception
