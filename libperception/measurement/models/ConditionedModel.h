#pragma once
#include <memory>
#include <optional>
#include <utility>

#include "libperception/measurement/models/ClutterMap.h"
#include "libperception/measurement/models/ForwardedModel.h"

namespace perception {

/// What the surroundings and the weather of a scan change in the model of its sensor.
struct SensorConditions {
  std::shared_ptr<const ClutterMap> clutter;  ///< null: as configured
  double seen_share = 1;  ///< (0, 1] of P_D that is left in this weather (method.md 4.8)
};

/// A sensor's model under the conditions of a scan.
class ConditionedModel final : public ForwardedModel {
 public:
  ConditionedModel(std::shared_ptr<const MeasurementModel> model, SensorConditions conditions)
      : ForwardedModel(std::move(model)), conditions_(std::move(conditions)) {}

  const PositionOnlyModel* positionOnly() const override {
    return conditions_.seen_share < 1 ? nullptr : model_->positionOnly();
  }
  double detectionProbability(ClassId c, const Kinematics& object, const Extent& extent,
                              const SensorState& sensor, double visibility) const override;
  double logClutterDensity(const Measurement& m, const SensorState& sensor) const override;

 private:
  SensorConditions conditions_;
};

/// The cell of a measurement's approximate position.
std::size_t cellOf(const Measurement& m, const SensorState& sensor, const ViewCells& cells);

}  // namespace perception
