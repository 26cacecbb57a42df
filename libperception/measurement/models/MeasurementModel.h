#pragma once
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "libperception/core/Kinematics.h"
#include "libperception/core/math/Angle.h"
#include "libperception/measurement/Measurement.h"
#include "libperception/measurement/objects/ObjectClass.h"

namespace perception {

/// How two values of an axis are subtracted.
enum class AxisKind {
  kLinear,
  kAngle  ///< [rad], wrapped to (-pi, pi]
};

/// How h is linearized in the aspect of an object, its heading relative to the line of sight
/// (filter/likelihood/Linearization.h).
enum class AspectLine {
  kNone,    ///< h does not depend on it, or is linear enough
  kChord,   ///< slope and spread from wide sigma points
  kTangent  ///< slope of the tangent, spread from wide sigma points
};

/// Predicted measurement of one object: h and its Jacobians. Not `defined`: no prediction exists
/// (the sensor is at the object).
struct AxisPrediction {
  AxisVector h;
  Eigen::Matrix<double, Eigen::Dynamic, 5, Eigen::ColMajor, kMaxAxes, 5>
      H_q;  ///< dh/d(x, y, vx, vy, yaw)
  Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::ColMajor, kMaxAxes, 2>
      H_extent;        ///< dh/d(length, width)
  AxisMatrix R_model;  ///< model uncertainty for this class, added to R; empty: none
  bool defined = false;
};

/// Velocity information of a range rate: the component along the line of sight and, where the
/// sensor configuration bounds it, the spread of the component across.
struct RadialSpeed {
  Vector2 direction = Vector2::UnitX();  ///< unit vector, world
  ScalarEstimate along;                  ///< [m/s, m^2/s^2]
  std::optional<double> across_sigma;    ///< [m/s]; empty: that of the class
};

/// Initial state of a newborn object of one class from one measurement.
struct BirthState {
  Vector2 position = Vector2::Zero();        ///< [m] center, world
  Matrix2 covariance = Matrix2::Identity();  ///< [m^2]
  std::optional<ScalarEstimate> yaw;         ///< [rad, rad^2] world; its direction or its opposite
  std::optional<ScalarEstimate> speed;       ///< [m/s] along yaw
  std::optional<RadialSpeed> radial_speed;   ///< of objects without yaw
  Extent extent;
};

class PositionOnlyModel;

/// How one kind of sensor sees one kind of object. Batched, to keep virtual calls out of the inner
/// loop. Labels, P_D and clutter are those of [sensor.LABEL]; all densities are per unit of the
/// axes seen.
class MeasurementModel {
 public:
  virtual ~MeasurementModel() = default;

  virtual const std::vector<AxisKind>& axes() const = 0;
  /// This model when its z is the object's position and nothing else, which allows shorter code for
  /// the same numbers (method.md 4.4); null: any other model.
  virtual const PositionOnlyModel* positionOnly() const { return nullptr; }
  /// Axes that update the extent. A range depends on the length only together with the position,
  /// whose correlation with the extent is not kept: it does not update the extent, but the variance
  /// of the extent enters its S.
  virtual AxisMask extentAxes() const { return 0xff; }
  /// h, dh/dq, dh/dextent into out[0..count) of `count` objects, object i of class i % classes (a
  /// batch holds whole banks). World frame.
  virtual void predict(const Kinematics* objects, const Extent* extents, std::size_t count,
                       const SensorState& sensor, AxisPrediction* out) const = 0;
  /// How h of an object with a heading is linearized in its aspect.
  virtual AspectLine aspectLine() const { return AspectLine::kNone; }
  /// Adds to R_model the noise by which one class is measured less exactly, at any aspect.
  virtual void addClassNoise(ClassId c, const Kinematics& object, const SensorState& sensor,
                             AxisPrediction& prediction) const {
    (void)c, (void)object, (void)sensor, (void)prediction;
  }
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
  /// The same for detections and missed detections: over hundreds of scans an error of P_D in the
  /// percent range would decide the class.
  virtual double detectionExponent() const { return 1; }
  /// Factor in (0, 1] of [filter] kinematic_exponent. It is below 1 if the innovations depend on a
  /// size that Measurement::log_class has already used as evidence.
  virtual double innovationShare() const { return 1; }
  /// How the errors of Measurement::log_class repeat; null: they do not. Replaces labelExponent().
  virtual const EvidenceMemory* evidenceMemory() const { return nullptr; }
  /// How the errors of detection, label and score of one object repeat, missed detections included;
  /// null: they do not. Replaces labelExponent() and detectionExponent().
  virtual const EvidenceMemory* lookMemory() const { return nullptr; }
  /// log P(label | clutter).
  virtual double logLabelClutter(int label) const = 0;
  /// Log of the expected number of false measurements per scan and unit of the axes seen at z.
  virtual double logClutterDensity(const Measurement& m, const SensorState& sensor) const = 0;
  /// The same for births of class c, without the class prior.
  virtual double logBirthDensity(const Measurement& m, ClassId c,
                                 const SensorState& sensor) const = 0;
  /// The newborn object of class c; empty when this measurement cannot start one.
  virtual std::optional<BirthState> birth(const Measurement& m, ClassId c,
                                          const SensorState& sensor) const = 0;
};

/// log p(label, score | class, detected), from `log_class` of the measurement or the label table.
double logLabelAndScore(const MeasurementModel& model, const Measurement& m, ClassId c);
/// The same for clutter.
double logClutterLabelAndScore(const MeasurementModel& model, const Measurement& m);
/// The part of logLabelAndScore() that depends on the class.
double logLabelOf(const MeasurementModel& model, const Measurement& m, ClassId c);

/// Whether a disc of radius `reach` [m] about `center` (world) touches the sector of full angle
/// `fov` [rad] and radius `range` [m] about the sensor's forward axis. Conservative near the
/// origin: may be true without contact.
bool touchesSector(const Vector2& center, double reach, double fov, double range,
                   const SensorState& sensor);
/// Half of a field of view, its sine and cosine taken once.
struct HalfAngle {
  explicit HalfAngle(double angle)
      : cosine(std::cos(angle)), sine(std::sin(angle)), all(angle >= kPi) {}
  double cosine, sine;
  bool all;  ///< the full circle
};
/// touchesSector() for many discs and one field of view.
bool touchesSector(const Vector2& center, double reach, const HalfAngle& half_fov, double range,
                   const SensorState& sensor);

/// z - h of the axes seen, angles wrapped, packed in axis order.
AxisVector residual(const MeasurementModel& model, const Measurement& m, const AxisVector& h);

}  // namespace perception
