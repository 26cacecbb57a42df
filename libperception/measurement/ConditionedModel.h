#pragma once
#include <memory>
#include <optional>
#include <utility>

#include "libperception/measurement/ClutterMap.h"
#include "libperception/measurement/MeasurementModel.h"

namespace perception {

/// What the surroundings and the weather of a scan change in the model of its sensor.
struct SensorConditions {
  std::shared_ptr<const ClutterMap> clutter;  ///< null: as configured
  double seen_share = 1;  ///< (0, 1] of P_D that is left in this weather (method.md 4.8)
};

/// A sensor's model under the conditions of a scan.
class ConditionedModel final : public MeasurementModel {
 public:
  ConditionedModel(std::shared_ptr<const MeasurementModel> model, SensorConditions conditions)
      : model_(std::move(model)), conditions_(std::move(conditions)) {}

  const std::vector<AxisKind>& axes() const override { return model_->axes(); }
  const PositionOnlyModel* positionOnly() const override {
    return conditions_.seen_share < 1 ? nullptr : model_->positionOnly();
  }
  AxisMask extentAxes() const override { return model_->extentAxes(); }
  void predict(const Kinematics* objects, const Extent* extents, std::size_t count,
               const SensorState& sensor, AxisPrediction* out) const override {
    model_->predict(objects, extents, count, sensor, out);
  }
  AspectLine aspectLine() const override { return model_->aspectLine(); }
  double detectionProbability(ClassId c, const Kinematics& object, const Extent& extent,
                              const SensorState& sensor, double visibility) const override;
  bool mayDetect(const Vector2& position, double reach, const SensorState& sensor) const override {
    return model_->mayDetect(position, reach, sensor);
  }
  double logLabelLikelihood(int label, ClassId c) const override {
    return model_->logLabelLikelihood(label, c);
  }
  double labelExponent() const override { return model_->labelExponent(); }
  double detectionExponent() const override { return model_->detectionExponent(); }
  double innovationShare() const override { return model_->innovationShare(); }
  const EvidenceMemory* evidenceMemory() const override { return model_->evidenceMemory(); }
  const EvidenceMemory* lookMemory() const override { return model_->lookMemory(); }
  double logLabelClutter(int label) const override { return model_->logLabelClutter(label); }
  double logClutterDensity(const Measurement& m, const SensorState& sensor) const override;
  double logBirthDensity(const Measurement& m, ClassId c,
                         const SensorState& sensor) const override {
    return model_->logBirthDensity(m, c, sensor);
  }
  std::optional<BirthState> birth(const Measurement& m, ClassId c,
                                  const SensorState& sensor) const override {
    return model_->birth(m, c, sensor);
  }

 private:
  std::shared_ptr<const MeasurementModel> model_;
  SensorConditions conditions_;
};

/// The cell of a measurement's approximate position.
std::size_t cellOf(const Measurement& m, const SensorState& sensor, const ViewCells& cells);

}  // namespace perception
