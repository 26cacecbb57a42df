#pragma once
#include "libperception/measurement/FootprintModel.h"

namespace perception {

/// What a radar unit's model needs besides the tables of its sensor; a part of
/// [sensor.LABEL.radar]. Sources: method.md 4.3.
struct RadarModelParams {
  double rate_span = 53.6;  ///< [m/s] over which range rates of clutter spread [cornell2007]
  /// Of clutter: posts, rails, the road (View of Delft: .83 of all returns [palffy2022]); the
  /// others have any rate.
  double standing_share = 0.8;
  /// [m/s] over ground along the line of sight: returns below it may be of anything that stands and
  /// start no objects; assumed.
  double min_birth_speed = 0.5;
  /// ... nor those within so many of its own deviations of standing: an uncertain bearing turns own
  /// motion into the return's; tuned on simulated drives.
  double min_birth_sigmas = 3;
  /// [rad] of a newborn's course about the line of sight: 30 deg [cornell2007]; 90 deg: unknown.
  double birth_heading_sigma = radians(90);
  /// Share of P_D that is left for objects that a lidar finds occluded: radar sees past and below
  /// vehicles, through snow; assumed.
  double occluded_detection = 0.5;
  /// [rad] deviation of the border of the view: detections fade there; assumed.
  double view_edge = radians(2);
  /// Of the object's depth along the line of sight, added to the range's deviation: returns come
  /// from wheels and inside, too; assumed.
  double depth_share = 0.15;

  void visit(ParamVisitor& v);
};

/// Sees where an object reflects and how fast that point comes or goes: z = (range [m] on the
/// ground, bearing [rad] counter-clockwise off the sensor's forward axis, range rate [m/s] against
/// the moving sensor, > 0 moves away). method.md 4.3.
///
/// The reflecting point lies on the near side: the range is that of the footprint's nearest point,
/// the bearing that of the middle of its outline, with the outline's width as uncertainty of the
/// model (R_model). A point off the middle has another line of sight and so another range rate: the
/// two errors go together.
class RadarModel final : public MeasurementModel {
 public:
  enum Axis { kRange, kBearing, kRate, kAxes };
  static constexpr AxisMask kAll = 7, kNoRate = 3;

  RadarModel(ClassTable classes, DetectionModel detection_model, RadarModelParams params);

  const std::vector<AxisKind>& axes() const override;
  AxisMask extentAxes() const override { return 0; }  ///< one point says nothing of a size
  /// A chord would take a share of each range rate's speed for an error of the heading: of 60
  /// simulated drives with radars alone 19 end with a wrong speed or place, with the tangent 9.
  AspectLine aspectLine() const override { return AspectLine::kTangent; }
  void predict(const Kinematics* objects, const Extent* extents, std::size_t count,
               const SensorState& sensor, AxisPrediction* out) const override;
  double detectionProbability(ClassId c, const Kinematics& object, const Extent& extent,
                              const SensorState& sensor, double visibility) const override;
  bool mayDetect(const Vector2& position, double reach, const SensorState& sensor) const override;
  double detectionExponent() const override {
    return detection_model().params().detection_exponent;
  }
  double logLabelLikelihood(int, ClassId) const override { return 0; }  ///< radars give no labels
  double logLabelClutter(int) const override { return 0; }
  double logClutterDensity(const Measurement& m, const SensorState& sensor) const override;
  double logBirthDensity(const Measurement& m, ClassId c, const SensorState& sensor) const override;
  std::optional<BirthState> birth(const Measurement& m, ClassId c,
                                  const SensorState& sensor) const override;

  const DetectionModel& detection_model() const { return footprint_.detection_model(); }

 private:
  /// Share of detections left at a bearing [rad] of the outline.
  double edgeShare(double bearing) const;
  /// Whether object i of a batch has a length axis: batches hold whole banks.
  bool isWheeled(std::size_t i) const {
    return classes_.classes[i % classes_.classes.size()].motion->has_heading;
  }

  ClassTable classes_;
  FootprintModel footprint_;
  RadarModelParams params_;
};

/// [m/s, m^2/s^2] of the reflecting point over ground, along the line of sight as measured.
ScalarEstimate groundSpeed(const Measurement& m, const SensorState& sensor);

/// [m/s] world: velocity of a sensor on a vehicle that drives and turns (lever arm included).
Vector2 sensorVelocity(const SensorState& sensor);

}  // namespace perception
