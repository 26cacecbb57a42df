#pragma once
#include "libperception/measurement/models/DetectionModel.h"
#include "libperception/measurement/models/MeasurementModel.h"

namespace perception {

/// [rad] in (-pi, pi], counter-clockwise: middle bearing of an object between its edges, also
/// across the rear.
inline double middleBearing(double left, double right) {
  return wrapAngle(right + 0.5 * wrapAngle(left - right));
}

/// Outline of an object's footprint: z = (bearing of its left edge, bearing of its right edge,
/// range of its nearest point), bearings [rad] counter-clockwise off the sensor's forward axis in
/// the horizontal plane, range [m]. For lidar clusters and for image boxes, whose lower edge gives
/// the range. method.md 4.1.
///
/// An oriented object is the rectangle (length, width, yaw) about its center; one without yaw is a
/// disc whose diameter is the mean of its length and width. Left is the counter-clockwise edge as
/// seen from the sensor. "Forward" is the x axis of T_world_sensor: the front end of a camera
/// passes its level frame, not the optical one.
class FootprintModel : public MeasurementModel {
 public:
  /// Rows of z.
  enum Axis { kLeft, kRight, kRange, kAxes };
  static constexpr AxisMask kAll = 7;

  FootprintModel(ClassTable classes, DetectionModel detection_model);

  const std::vector<AxisKind>& axes() const override;
  AxisMask extentAxes() const override { return 1 << kLeft | 1 << kRight; }
  AspectLine aspectLine() const override { return AspectLine::kChord; }
  void predict(const Kinematics* objects, const Extent* extents, std::size_t count,
               const SensorState& sensor, AxisPrediction* out) const override;
  void addClassNoise(ClassId c, const Kinematics& object, const SensorState& sensor,
                     AxisPrediction& prediction) const override;
  double detectionProbability(ClassId c, const Kinematics& object, const Extent& extent,
                              const SensorState& sensor, double visibility) const override;
  bool mayDetect(const Vector2& position, double reach, const SensorState& sensor) const override {
    return touchesSector(position, reach, detection_model_.params().fov,
                         detection_model_.params().range_max, sensor);
  }
  double logLabelLikelihood(int label, ClassId c) const override {
    return detection_model_.logLabel(label, c);
  }
  double labelExponent() const override { return detection_model_.params().label_exponent; }
  double detectionExponent() const override { return detection_model_.params().detection_exponent; }
  double logLabelClutter(int label) const override {
    return detection_model_.logLabelClutter(label);
  }
  double logClutterDensity(const Measurement& m, const SensorState& sensor) const override;
  double logBirthDensity(const Measurement& m, ClassId c, const SensorState& sensor) const override;
  std::optional<BirthState> birth(const Measurement& m, ClassId c,
                                  const SensorState& sensor) const override;

  const DetectionModel& detection_model() const { return detection_model_; }

 protected:
  /// [0, 1] share of the object's width, as seen from the sensor, within the field of view.
  double shareInView(const Kinematics& object, const Extent& extent,
                     const SensorState& sensor) const;

 private:
  ClassTable classes_;
  DetectionModel detection_model_;
};

}  // namespace perception
