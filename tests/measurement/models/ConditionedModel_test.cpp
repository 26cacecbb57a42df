#include "libperception/measurement/models/ConditionedModel.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/measurement/models/PositionModel.h"

namespace perception {
namespace {

std::shared_ptr<const PositionModel> positions() {
  PositionModel::Params p;
  PositionModel::ClassRow row;
  row.detection = 0.8;
  row.labels = {1};
  p.classes = {row};
  p.clutter_labels = {1};
  p.clutter_per_scan = 0.6;
  p.range = 60;
  return std::make_shared<const PositionModel>(p);
}

Measurement at(double x, double y) {
  Measurement m;
  m.z = m.position = Vector2(x, y);
  m.R = Matrix2::Identity();
  m.seen = 3;
  return m;
}

TEST(ConditionedModel, WithoutConditionsIsTheModel) {
  const auto model = positions();
  const ConditionedModel same(model, {});
  const Measurement m = at(20, 3);
  EXPECT_EQ(same.logClutterDensity(m, {}), model->logClutterDensity(m, {}));
  EXPECT_EQ(same.logBirthDensity(m, 0, {}), model->logBirthDensity(m, 0, {}));
  EXPECT_EQ(same.positionOnly(), model->positionOnly());
  Kinematics object;
  object.q << 20, 3, 0, 0, 0;
  EXPECT_EQ(same.detectionProbability(0, object, {}, {}, 1),
            model->detectionProbability(0, object, {}, {}, 1));
}

TEST(ConditionedModel, HasTheLearnedClutterOfTheCell) {
  DetectionParams view;
  view.clutter_per_scan = 0.6, view.range_max = 60, view.fov = kPi;
  auto map = std::make_shared<ClutterMap>(view);
  SensorState sensor;
  sensor.T_world_sensor = makePose(5, -2, 1, radians(30));
  const Measurement near = at(5 + 8 * std::cos(radians(50)), -2 + 8 * std::sin(radians(50)));
  const std::size_t cell = cellOf(near, sensor, map->cells());
  EXPECT_EQ(cell, map->cells().at(8, radians(20)));
  for (int scan = 0; scan < 100; ++scan) {
    std::vector<double> clutter(map->cells().size(), 0);
    clutter[cell] = 2;
    map->add(clutter, 0.1);
  }
  const auto model = positions();
  const ConditionedModel learned(model, {map, 1});
  EXPECT_GT(map->logFactor(cell), 1);
  EXPECT_DOUBLE_EQ(learned.logClutterDensity(near, sensor),
                   model->logClutterDensity(near, sensor) + map->logFactor(cell));
  const Measurement far = at(50, 10);
  EXPECT_LT(map->logFactor(cellOf(far, sensor, map->cells())), map->logFactor(cell) - 1);
  EXPECT_DOUBLE_EQ(
      learned.logClutterDensity(far, sensor),
      model->logClutterDensity(far, sensor) + map->logFactor(cellOf(far, sensor, map->cells())));
}

TEST(ConditionedModel, BadWeatherLeavesAShareOfTheDetections) {
  const auto model = positions();
  const ConditionedModel rain(model, {nullptr, 0.5});
  Kinematics object;
  object.q << 20, 3, 0, 0, 0;
  EXPECT_DOUBLE_EQ(rain.detectionProbability(0, object, {}, {}, 1), 0.4);
  EXPECT_EQ(rain.logClutterDensity(at(20, 3), {}), model->logClutterDensity(at(20, 3), {}));
  EXPECT_EQ(rain.positionOnly(), nullptr);  // whose P_D is that of clear air
}

}  // namespace
}  // namespace perception
