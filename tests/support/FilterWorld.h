#pragma once
#include <memory>
#include <vector>

#include "libperception/filter/state/FilterModel.h"
#include "libperception/measurement/models/PositionModel.h"

namespace perception::test {

/// A pedestrian (constant velocity) and a static class, both linear: everything about them has a
/// closed form.
inline ClassTable linearClasses() {
  ClassTable table;
  ObjectClass walker;
  walker.name = "pedestrian";
  walker.motion = findMotionModel("constant-velocity");
  walker.accel_psd = 0.5;
  walker.position_psd = 0;
  walker.prior = 0.6;
  walker.max_speed = 4;
  ObjectClass pole;
  pole.name = "static-other";
  pole.motion = findMotionModel("static");
  pole.position_psd = 1e-3;
  pole.prior = 0.4;
  pole.max_speed = 0;
  table.classes = {walker, pole};
  return table;
}

/// The exact Bayesian recursion: no tempering, no floor, no forgetting, nothing pruned.
inline FilterModel exactModel(ClassTable classes) {
  FilterModel model;
  model.classes = std::move(classes);
  model.params.gate_probability = 1 - 1e-12;
  model.params.survival_in_view = model.params.survival_out_of_view = 20;
  model.params.existence_min = 1e-9;
  model.params.existence_max = 1;
  model.params.class_epsilon = 0;
  model.params.speed_slack = 0;
  model.params.height_exponent = 0;
  model.params.side_exponent = 0;
  model.params.merge_area = 0;
  model.params.class_forgetting = 1e18;
  model.params.kinematic_exponent = 1;
  return model;
}

/// These two and a wheeled class, "car".
inline FilterModel threeClassModel() {
  FilterModel model = exactModel(linearClasses());
  ObjectClass car = model.classes[0];
  car.name = "car";
  car.motion = findMotionModel("wheeled");
  car.yaw_rate_psd = 0.0685;
  model.classes.classes.push_back(car);
  return model;
}

inline PositionModel::Params linearSensor() {
  PositionModel::Params p;
  p.classes.resize(2);
  p.classes[0].detection = 0.8;
  p.classes[0].labels = {0.7, 0.3};
  p.classes[0].noise = 0.04 * Matrix2::Identity();
  p.classes[1].detection = 0.6;
  p.classes[1].labels = {0.4, 0.6};
  p.classes[1].noise = 0.09 * Matrix2::Identity();
  p.clutter_labels = {0.5, 0.5};
  p.clutter_per_scan = 8;  // .0016 per m^2
  p.births_per_scan = 4.8;
  p.range = 40;  // nothing ever leaves the view
  p.fov = kTwoPi;
  return p;
}

struct LabeledPoint {
  double x, y;
  int label;
};

inline MeasurementScan positionScan(const std::shared_ptr<const PositionModel>& model, double t,
                                    const std::vector<LabeledPoint>& points) {
  MeasurementScan scan;
  scan.sensor = "POSITION";
  scan.model = model;
  scan.state.stamp = scan.state.ego.stamp = Stamp::fromSeconds(1000 + t);
  for (const auto& p : points) {
    Measurement m;
    m.z = Vector2(p.x, p.y);
    m.R = 1e-4 * Matrix2::Identity();
    m.seen = 3;
    m.label = p.label;
    m.position = m.z;
    m.position_sigma = 5;
    scan.measurements.push_back(m);
  }
  return scan;
}

}  // namespace perception::test
