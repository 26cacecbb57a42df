#pragma once
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "libperception/core/Angle.h"
#include "libperception/core/Kinematics.h"
#include "libperception/measurement/Measurement.h"
#include "libperception/measurement/ObjectClass.h"

namespace perception {

/// How two values of an axis are subtracted.
enum class AxisKind {
  kLinear,
  kAngle  ///< [rad], wrapped to (-pi, pi]
};

/// How a prediction is made linear along the aspect of an object, the heading as seen from the
/// sensor (filter/Linearization).
enum class AspectLine {
  kNone,    ///< h does not depend on it, or is linear enough
  kChord,   ///< slope and spread from wide sigma points
  kTangent  ///< the tangent's slope, the spread from wide sigma points
};

/// What one object would look like: h and its derivatives. Not `defined`: the model cannot say
/// (object at the sensor).
struct AxisPrediction {
  AxisVector h;
  Eigen::Matrix<double, Eigen::Dynamic, 5, Eigen::ColMajor, kMaxAxes, 5>
      H_q;  ///< dh/d(x, y, vx, vy, yaw)
  Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::ColMajor, kMaxAxes, 2>
      H_extent;  ///< dh/d(length, width)
  AxisMatrix
      R_model;  ///< what the model itself is unsure of for this class, added to R; empty: nothing
  bool defined = false;
};

/// What a range rate says of a velocity: its component along one direction, and, where the sensor's
/// site tells, how large the component across it may be.
struct RadialSpeed {
  Vector2 direction = Vector2::UnitX();  ///< unit vector, world
  ScalarEstimate along;                  ///< [m/s, m^2/s^2]
  std::optional<double> across_sigma;    ///< [m/s]; empty: whatever the class allows
};

/// Where a newborn object of one class stands, from one measurement.
struct BirthState {
  Vector2 position = Vector2::Zero();        ///< [m] center, world
  Matrix2 covariance = Matrix2::Identity();  ///< [m^2]
  std::optional<ScalarEstimate> yaw;         ///< [rad, rad^2] world; its direction or its opposite
  std::optional<ScalarEstimate> speed;       ///< [m/s] along yaw
  std::optional<RadialSpeed> radial_speed;   ///< of objects whose yaw is not known
  Extent extent;
};

class PositionOnlyModel;

/// How one kind of sensor sees one kind of object. Batched, so that no virtual call stands in the
/// inner loop. Labels, detection and clutter are per class and per scan as in [sensor.LABEL]; all
/// densities are per unit of the axes seen.
class MeasurementModel {
 public:
  virtual ~MeasurementModel() = default;

  virtual const std::vector<AxisKind>& axes() const = 0;
  /// Of a model whose z is the object's position and nothing else: itself, for the shorter way to
  /// the same numbers (method.md 4.4); null: any other model.
  virtual const PositionOnlyModel* positionOnly() const { return nullptr; }
  /// Axes that correct the extent. A range tells of length only together with the center's place,
  /// whose correlation with the extent is not kept: it is left out there, but counts in S.
  virtual AxisMask extentAxes() const { return 0xff; }
  /// h, dh/dq, dh/dextent into out[0..count) of `count` objects, object i taken as one of class i %
  /// classes: batches hold whole banks.
  virtual void predict(const Kinematics* objects, const Extent* extents, std::size_t count,
                       const SensorState& sensor, AxisPrediction* out) const = 0;
  /// Whether, and how, h of an object with a heading follows the side that it shows the sensor.
  virtual AspectLine aspectLine() const { return AspectLine::kNone; }
  /// P(detected | class, state), in [0, 1]: 0 outside the field of view; `visibility` in [0, 1] is
  /// the share not occluded.
  virtual double detectionProbability(ClassId c, const Kinematics& object, const Extent& extent,
                                      const SensorState& sensor, double visibility) const = 0;
  /// False when nothing within `reach` [m] of `position` (world) could be detected: a cheap bound.
  virtual bool mayDetect(const Vector2& position, double reach, const SensorState& sensor) const {
    (void)position, (void)reach, (void)sensor;
    return true;
  }
  /// log P(label | class, detected).
  virtual double logLabelLikelihood(int label, ClassId c) const = 0;
  /// Exponent in (0, 1] of the label in the class update: labels of one object are not independent
  /// (method.md 5.6).
  virtual double labelExponent() const { return 1; }
  /// The same of detections and misses; where hundreds of them come, no table knows P_D to the
  /// percent that they would tell.
  virtual double detectionExponent() const { return 1; }
  /// log P(label | clutter).
  virtual double logLabelClutter(int label) const = 0;
  /// Log of the expected number of false measurements per scan and unit of the axes seen at z.
  virtual double logClutterDensity(const Measurement& m, const SensorState& sensor) const = 0;
  /// The same for first measurements of newborn objects of class c (the class prior not included).
  virtual double logBirthDensity(const Measurement& m, ClassId c,
                                 const SensorState& sensor) const = 0;
  /// The newborn object of class c; empty when this measurement cannot start one.
  virtual std::optional<BirthState> birth(const Measurement& m, ClassId c,
                                          const SensorState& sensor) const = 0;
};

/// log p(label, score | class, detected), whichever way the measurement gives it.
double logLabelAndScore(const MeasurementModel& model, const Measurement& m, ClassId c);
/// The same of clutter.
double logClutterLabelAndScore(const MeasurementModel& model, const Measurement& m);
/// The part of logLabelAndScore() that tells classes apart.
double logLabelOf(const MeasurementModel& model, const Measurement& m, ClassId c);

/// Whether a disc of radius `reach` [m] about `center` (world) touches the sector of full angle
/// `fov` [rad] and radius `range` [m] about the sensor's forward axis. Near the origin it may say
/// true too often.
bool touchesSector(const Vector2& center, double reach, double fov, double range,
                   const SensorState& sensor);
/// Half of a field of view, its sine and cosine taken once.
struct HalfAngle {
  explicit HalfAngle(double angle)
      : cosine(std::cos(angle)), sine(std::sin(angle)), all(angle >= kPi) {}
  double cosine, sine;
  bool all;  ///< the full circle
};
/// touchesSector() for a field of view that many discs are held against.
bool touchesSector(const Vector2& center, double reach, const HalfAngle& half_fov, double range,
                   const SensorState& sensor);

/// z - h of the axes seen, angles wrapped, packed in axis order.
AxisVector residual(const MeasurementModel& model, const Measurement& m, const AxisVector& h);

}  // namespace perception
