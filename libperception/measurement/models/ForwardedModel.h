#pragma once
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "libperception/measurement/models/MeasurementModel.h"

namespace perception {

/// Another model, for those that change a part of it.
class ForwardedModel : public MeasurementModel {
 public:
  explicit ForwardedModel(std::shared_ptr<const MeasurementModel> model)
      : model_(std::move(model)) {}

  const std::vector<AxisKind>& axes() const override { return model_->axes(); }
  const PositionOnlyModel* positionOnly() const override { return model_->positionOnly(); }
  AxisMask extentAxes() const override { return model_->extentAxes(); }
  void predict(const Kinematics* objects, const Extent* extents, std::size_t count,
               const SensorState& sensor, AxisPrediction* out) const override {
    model_->predict(objects, extents, count, sensor, out);
  }
  AspectLine aspectLine() const override { return model_->aspectLine(); }
  void addClassNoise(ClassId c, const Kinematics& object, const SensorState& sensor,
                     AxisPrediction& prediction) const override {
    model_->addClassNoise(c, object, sensor, prediction);
  }
  double detectionProbability(ClassId c, const Kinematics& object, const Extent& extent,
                              const SensorState& sensor, double visibility) const override {
    return model_->detectionProbability(c, object, extent, sensor, visibility);
  }
  bool mayDetect(const Vector2& position, double reach, const SensorState& sensor) const override {
    return model_->mayDetect(position, reach, sensor);
  }
  double logLabelLikelihood(int label, ClassId c) const override {
    return model_->logLabelLikelihood(label, c);
  }
  double labelExponent() const override { return model_->labelExponent(); }
  double detectionExponent() const override { return model_->detectionExponent(); }
  double innovationShare() const override { return model_->innovationShare(); }
  double aloneInnovationShare() const override { return model_->aloneInnovationShare(); }
  const EvidenceMemory* evidenceMemory() const override { return model_->evidenceMemory(); }
  const EvidenceMemory* lookMemory() const override { return model_->lookMemory(); }
  double logLabelClutter(int label) const override { return model_->logLabelClutter(label); }
  double logClutterDensity(const Measurement& m, const SensorState& sensor) const override {
    return model_->logClutterDensity(m, sensor);
  }
  double logBirthDensity(const Measurement& m, ClassId c,
                         const SensorState& sensor) const override {
    return model_->logBirthDensity(m, c, sensor);
  }
  std::optional<BirthState> birth(const Measurement& m, ClassId c,
                                  const SensorState& sensor) const override {
    return model_->birth(m, c, sensor);
  }

 protected:
  const std::shared_ptr<const MeasurementModel> model_;
};

}  // namespace perception
