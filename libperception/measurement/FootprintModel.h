#pragma once
#include "libperception/measurement/MeasurementModel.h"
#include "libperception/measurement/Sensing.h"

namespace perception {

/// Sees the outline of an object's footprint: z = (bearing of its left edge, bearing of its right
/// edge, range of its nearest point), bearings [rad] counter-clockwise off the sensor's forward
/// axis in the horizontal plane, range [m]. Lidar clusters and image boxes (whose lower edge gives
/// the range) are both of this kind. SPEC 4.1.
///
/// An oriented object is the rectangle (length, width, yaw) about its centre; one without yaw is a
/// disc whose diameter is the mean of its length and width. Left is the counter-clockwise edge as
/// seen from the sensor. "Forward" is the x axis of T_world_sensor: a camera's front end hands over
/// a frame with x forward instead of its optical one.
class FootprintModel : public MeasurementModel {
 public:
  enum Axis { kLeft, kRight, kRange, kAxes };
  static constexpr AxisMask kAll = 7;

  FootprintModel(ClassTable classes, Sensing sensing);

  const std::vector<AxisKind>& axes() const override;
  AxisMask extentAxes() const override { return 1 << kLeft | 1 << kRight; }
  AspectLine aspectLine() const override { return AspectLine::kChord; }
  void predict(const Kinematics* objects, const Extent* extents, std::size_t count,
               const SensorState& sensor, AxisPrediction* out) const override;
  double detectionProbability(ClassId c, const Kinematics& object, const Extent& extent,
                              const SensorState& sensor, double visibility) const override;
  bool mayDetect(const Vector2& position, double reach, const SensorState& sensor) const override {
    return touchesSector(position, reach, sensing_.params().fov, sensing_.params().range_max,
                         sensor);
  }
  double logLabelLikelihood(int label, ClassId c) const override {
    return sensing_.logLabel(label, c);
  }
  double labelExponent() const override { return sensing_.params().label_exponent; }
  double detectionExponent() const override { return sensing_.params().detection_exponent; }
  double logLabelClutter(int label) const override { return sensing_.logLabelClutter(label); }
  double logClutterDensity(const Measurement& m, const SensorState& sensor) const override;
  double logBirthDensity(const Measurement& m, ClassId c, const SensorState& sensor) const override;
  std::optional<BirthState> birth(const Measurement& m, ClassId c,
                                  const SensorState& sensor) const override;

  const Sensing& sensing() const { return sensing_; }

 private:
  ClassTable classes_;
  Sensing sensing_;
};

}  // namespace perception
