#pragma once
#include "libperception/measurement/models/FootprintModel.h"

namespace perception {

/// Parameters of the radar model besides the tables of [sensor.LABEL]; part of
/// [sensor.LABEL.radar]. Sources: method.md 4.3.
struct RadarModelParams {
  double rate_span = 53.6;  ///< [m/s] span of the range rates of clutter [cornell2007]
  /// Share of clutter that is stationary: poles, rails, the road (View of Delft: .83 of all returns
  /// [palffy2022]); the rest has any rate.
  double standing_share = 0.8;
  /// [m/s] over ground along the line of sight: slower returns may be of stationary structures and
  /// start no objects; assumed.
  double min_birth_speed = 0.5;
  /// The same in standard deviations of the ground speed: an uncertain bearing makes own motion
  /// appear as object motion; tuned on simulated drives.
  double min_birth_sigmas = 3;
  /// [rad] deviation of a newborn's course from the line of sight: 30 deg [cornell2007]; 90 deg:
  /// unknown.
  double birth_heading_sigma = radians(90);
  /// Factor of P_D for objects that a lidar reports as occluded: radar sees past and below vehicles
  /// and through snow; assumed.
  double occluded_detection = 0.5;
  /// [rad] standard deviation of the border of the field of view, across which P_D falls; assumed.
  double view_edge = radians(2);
  /// Share of the object's depth along the line of sight that is added to the deviation of the
  /// range: returns also come from wheels and the inside; method.md (17).
  double depth_share = 0.15;
  /// Share of the filter's exponent with which range, bearing and rate are evidence of the class:
  /// the errors of one object's returns repeat, and every return of a standing object says again
  /// that it stands.
  double innovation_share = 1;
  /// The same for objects that no lidar or image detector has told by shape or label.
  double alone_innovation_share = 1;

  void visit(ParamVisitor& v);
};

/// Range, bearing and range rate of the reflecting point of an object: z = (range [m] on the
/// ground, bearing [rad] counter-clockwise off the sensor's forward axis, range rate [m/s] against
/// the moving sensor, > 0 moves away). method.md 4.3.
///
/// The reflecting point lies on the near side: the range is that of the footprint's nearest point,
/// the bearing that of the middle of its outline, with the outline's width as uncertainty of the
/// model (R_model). A point off the middle has another line of sight and so another range rate: the
/// two errors are correlated, method.md (17).
class RadarModel final : public MeasurementModel {
 public:
  enum Axis { kRange, kBearing, kRate, kAxes };
  static constexpr AxisMask kAll = 7, kNoRate = 3;

  RadarModel(ClassTable classes, DetectionModel detection_model, RadarModelParams params);

  const std::vector<AxisKind>& axes() const override;
  AxisMask extentAxes() const override { return 0; }  ///< a point has no size
  /// The chord attributes a part of each range rate to the heading: of 60 simulated drives with
  /// radars alone 19 end with a wrong speed or position, with the tangent 9.
  AspectLine aspectLine() const override { return AspectLine::kTangent; }
  void predict(const Kinematics* objects, const Extent* extents, std::size_t count,
               const SensorState& sensor, AxisPrediction* out) const override;
  double detectionProbability(ClassId c, const Kinematics& object, const Extent& extent,
                              const SensorState& sensor, double visibility) const override;
  bool mayDetect(const Vector2& position, double reach, const SensorState& sensor) const override;
  double detectionExponent() const override {
    return detection_model().params().detection_exponent;
  }
  double innovationShare() const override { return params_.innovation_share; }
  double aloneInnovationShare() const override { return params_.alone_innovation_share; }
  double logLabelLikelihood(int, ClassId) const override { return 0; }  ///< radars give no labels
  double logLabelClutter(int) const override { return 0; }
  double logClutterDensity(const Measurement& m, const SensorState& sensor) const override;
  double logBirthDensity(const Measurement& m, ClassId c, const SensorState& sensor) const override;
  std::optional<BirthState> birth(const Measurement& m, ClassId c,
                                  const SensorState& sensor) const override;

  const DetectionModel& detection_model() const { return footprint_.detection_model(); }

 private:
  /// Factor of P_D at a bearing [rad] of the outline, from view_edge.
  double edgeShare(double bearing) const;
  /// Factor of P_D where the nearest point of the outline, which the radar measures, is about as
  /// near as range_min [m]: it rises from there on within a meter (assumed).
  double nearShare(double nearest) const;
  /// Whether the class of object i of a batch (whole banks) has a heading.
  bool isWheeled(std::size_t i) const {
    return classes_.classes[i % classes_.classes.size()].motion->has_heading;
  }

  ClassTable classes_;
  FootprintModel footprint_;
  RadarModelParams params_;
};

/// [m/s, m^2/s^2] speed of the reflecting point over ground along the measured line of sight.
ScalarEstimate groundSpeed(const Measurement& m, const SensorState& sensor);

/// [m/s] world: velocity of a sensor on a vehicle that drives and turns (lever arm included).
Vector2 sensorVelocity(const SensorState& sensor);

}  // namespace perception
