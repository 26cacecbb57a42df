#pragma once
#include <algorithm>
#include <cmath>

#include "libperception/measurement/models/MeasurementModel.h"
#include "libperception/measurement/models/PositionOnlyModel.h"

namespace perception {

/// A sensor that measures the center of an object: z = (x, y) [m, world]. GPS receivers on the
/// object, box centers, and simulated positions for studies of the association.
class PositionModel : public MeasurementModel, public PositionOnlyModel {
 public:
  struct ClassRow {
    double detection = 0.9;      ///< P(detected | in view, near)
    double full_range = 1e9;     ///< [m] up to which it is constant; falls linearly to 0 ...
    double last_range = 2e9;     ///< [m] ... here
    std::vector<double> labels;  ///< P(label | class, detected); sums to 1
    Matrix2 noise =
        Matrix2::Identity();  ///< [m^2] covariance of z about the center; Measurement::R is added
    Extent extent{};          ///< of newborn objects

    /// P(detected | at this range [m] in view).
    double detectionAt(double r) const {
      const double far = (r - full_range) / (last_range - full_range);
      return detection * (1 - std::clamp(far, 0.0, 1.0));
    }
  };
  struct Params {
    std::vector<ClassRow> classes;       ///< in the order of the class table
    std::vector<double> clutter_labels;  ///< P(label | clutter); sums to 1
    double clutter_per_scan = 0.6;       ///< kappa
    double births_per_scan = 0.03;       ///< beta
    double range = 20;  ///< [m] of the field of view, a sector about the sensor's forward axis
    double fov = kPi;   ///< [rad] its full angle; 2 pi or more: a full disc
    double label_exponent = 1, detection_exponent = 1;  ///< method.md 5.6
  };

  explicit PositionModel(Params params);

  const std::vector<AxisKind>& axes() const override;
  const PositionOnlyModel* positionOnly() const override { return this; }
  void predict(const Kinematics* objects, const Extent* extents, std::size_t count,
               const SensorState& sensor, AxisPrediction* out) const override;
  double detectionProbability(ClassId c, const Kinematics& object, const Extent& extent,
                              const SensorState& sensor, double visibility) const override;
  bool mayDetect(const Vector2& position, double reach, const SensorState& sensor) const override;
  double logLabelLikelihood(int label, ClassId c) const override;
  const Matrix2& placeNoise(ClassId c) const override {
    return params_.classes[static_cast<std::size_t>(c)].noise;
  }
  void placeDetection(const Vector2* places, std::size_t count, const SensorState& sensor,
                      double* out) const override;
  double labelExponent() const override { return params_.label_exponent; }
  double detectionExponent() const override { return params_.detection_exponent; }
  double logLabelClutter(int label) const override;
  double logClutterDensity(const Measurement& m, const SensorState& sensor) const override;
  double logBirthDensity(const Measurement& m, ClassId c, const SensorState& sensor) const override;
  std::optional<BirthState> birth(const Measurement& m, ClassId c,
                                  const SensorState& sensor) const override;

  const Params& params() const { return params_; }
  bool inView(const Vector2& position, const SensorState& sensor) const;
  double area() const {
    return 0.5 * std::min(params_.fov, kTwoPi) * params_.range * params_.range;
  }  ///< [m^2]

 private:
  /// |d| [m] of a position `d` relative to a sensor whose forward axis is `forward`; -1 when out of
  /// view.
  double rangeInView(const Vector2& d, const Vector2& forward) const;

  Params params_;
  HalfAngle half_fov_;
  double log_clutter_, log_birth_;
};

}  // namespace perception
