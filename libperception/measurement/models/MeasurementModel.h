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

/// How two values of one axis of a measurement are subtracted.
enum class AxisKind {
  kLinear,
  kAngle  ///< [rad], wrapped to (-pi, pi]
};

/// How the measurement function h is linearized in the aspect of an object. The aspect is its
/// heading relative to the line of sight (filter/likelihood/Linearization.h, method.md 4.6).
enum class AspectLine {
  kNone,    ///< h does not depend on the aspect, or is linear enough in it
  kChord,   ///< the slope and the spread come from sigma points far apart
  kTangent  ///< the slope is that of the tangent, the spread comes from sigma points far apart
};

/// Predicted measurement of one object: h and its Jacobians. If `defined` is false, no prediction
/// exists, because the sensor is at the object.
struct AxisPrediction {
  AxisVector h;
  Eigen::Matrix<double, Eigen::Dynamic, 5, Eigen::ColMajor, kMaxAxes, 5>
      H_q;  ///< dh/d(x, y, vx, vy, yaw)
  Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::ColMajor, kMaxAxes, 2>
      H_extent;        ///< dh/d(length, width)
  AxisMatrix R_model;  ///< uncertainty of the model for this class, added to R unless empty
  bool defined = false;
};

/// Initial state of a new object of one class, computed from one measurement. World frame.
struct BirthState {
  Vector2 position = Vector2::Zero();        ///< [m] center of the object
  Matrix2 covariance = Matrix2::Identity();  ///< [m^2]
  std::optional<ScalarEstimate> yaw;    ///< [rad, rad^2] of the axis; the front may be either end
  std::optional<ScalarEstimate> speed;  ///< [m/s] along yaw
  std::optional<RadialSpeed> radial_speed;  ///< for objects without yaw
  Extent extent;
};

class PositionOnlyModel;

/// How one kind of sensor sees the objects of every class (method.md 4). A new model implements the
/// pure virtual functions; all others have a default. Predictions are made in batches, which keeps
/// virtual calls out of the inner loop. Labels, the probability of detection P_D and clutter are
/// those of [sensor.LABEL]. Densities are per unit of the axes seen (Measurement::seen), and `log`
/// is the natural logarithm.
class MeasurementModel {
 public:
  virtual ~MeasurementModel() = default;

  virtual const std::vector<AxisKind>& axes() const = 0;
  /// This model if its z is the position of the object and nothing else, which allows shorter code
  /// for the same numbers (method.md 4.4); null for any other model.
  virtual const PositionOnlyModel* positionOnly() const { return nullptr; }
  /// Axes that update the extent. A range depends on the length only together with the position,
  /// and the correlation of position and extent is not kept. A range therefore does not update the
  /// extent, but the variance of the extent enters the innovation covariance S of the range.
  virtual AxisMask extentAxes() const { return 0xff; }
  /// Writes h, dh/dq and dh/dextent of `count` objects to out[0..count). Object i has the class
  /// i % (number of classes), since a batch holds whole banks: one entry per class. World frame.
  virtual void predict(const Kinematics* objects, const Extent* extents, std::size_t count,
                       const SensorState& sensor, AxisPrediction* out) const = 0;
  /// How h is linearized in the aspect of an object that has a heading.
  virtual AspectLine aspectLine() const { return AspectLine::kNone; }
  /// Adds noise to R_model for a class that is measured less exactly, whatever its aspect.
  virtual void addClassNoise(ClassId c, const Kinematics& object, const SensorState& sensor,
                             AxisPrediction& prediction) const {
    (void)c, (void)object, (void)sensor, (void)prediction;
  }
  /// P(detected | class, state), in [0, 1]. It is 0 outside the field of view. `visibility`, in
  /// [0, 1], is the share of the object that is not occluded.
  virtual double detectionProbability(ClassId c, const Kinematics& object, const Extent& extent,
                                      const SensorState& sensor, double visibility) const = 0;
  /// False if nothing within `reach` [m] of `position` ([m], world) could be detected. A cheap
  /// bound: it may be true although nothing can be detected there.
  virtual bool mayDetect(const Vector2& position, double reach, const SensorState& sensor) const {
    (void)position, (void)reach, (void)sensor;
    return true;
  }
  /// log P(label | class, detected).
  virtual double logLabelLikelihood(int label, ClassId c) const = 0;
  /// Exponent in (0, 1] of the label likelihood in the class update, because the labels of one
  /// object are not independent (method.md 5.6).
  virtual double labelExponent() const { return 1; }
  /// Exponent in (0, 1] of detections and missed detections in the class update. Without it, an
  /// error of P_D of a few percent would decide the class over hundreds of scans.
  virtual double detectionExponent() const { return 1; }
  /// Factor in (0, 1] by which [filter] kinematic_exponent is multiplied. It is below 1 if the
  /// innovations depend on a size that Measurement::log_class has already used as evidence.
  virtual double innovationShare() const { return 1; }
  /// The same for objects of which no sensor has evidence that repeats (Track::evidence), so that
  /// their motion tells most.
  virtual double aloneInnovationShare() const { return innovationShare(); }
  /// How the errors of Measurement::log_class repeat from view to view; null if they do not. If it
  /// is not null, it replaces labelExponent().
  virtual const EvidenceMemory* evidenceMemory() const { return nullptr; }
  /// How the errors of detection, label and score of one object repeat, missed detections included;
  /// null if they do not. If it is not null, it replaces labelExponent() and detectionExponent().
  virtual const EvidenceMemory* lookMemory() const { return nullptr; }
  /// log P(label | clutter).
  virtual double logLabelClutter(int label) const = 0;
  /// Log of the clutter density at z: the expected number of false measurements per scan and per
  /// unit of the axes seen.
  virtual double logClutterDensity(const Measurement& m, const SensorState& sensor) const = 0;
  /// Log of the birth density of class c at z, in the same unit, without the class prior.
  virtual double logBirthDensity(const Measurement& m, ClassId c,
                                 const SensorState& sensor) const = 0;
  /// The initial state of a new object of class c; empty if this measurement cannot start one.
  virtual std::optional<BirthState> birth(const Measurement& m, ClassId c,
                                          const SensorState& sensor) const = 0;
};

/// log p(label, score | class, detected), from `log_class` of the measurement if it has one, else
/// from the label table and the score.
double logLabelAndScore(const MeasurementModel& model, const Measurement& m, ClassId c);
/// log p(label, score | clutter) in the same way.
double logClutterLabelAndScore(const MeasurementModel& model, const Measurement& m);
/// The part of logLabelAndScore() that depends on the class.
double logLabelOf(const MeasurementModel& model, const Measurement& m, ClassId c);

/// Whether a disc of radius `reach` [m] about `center` ([m], world) touches the sector of full
/// angle `fov` [rad] and radius `range` [m] about the sensor's forward axis. The test is
/// conservative near the origin: it may be true without contact.
bool touchesSector(const Vector2& center, double reach, double fov, double range,
                   const SensorState& sensor);
/// Half of a field of view [rad], with its sine and cosine computed once.
struct HalfAngle {
  explicit HalfAngle(double angle)
      : cosine(std::cos(angle)), sine(std::sin(angle)), all(angle >= kPi) {}
  double cosine, sine;
  bool all;  ///< the field of view is the full circle
};
/// The same for many discs and one field of view.
bool touchesSector(const Vector2& center, double reach, const HalfAngle& half_fov, double range,
                   const SensorState& sensor);

/// z - h of the axes seen, in axis order without gaps; angles are wrapped.
AxisVector residual(const MeasurementModel& model, const Measurement& m, const AxisVector& h);

}  // namespace perception
