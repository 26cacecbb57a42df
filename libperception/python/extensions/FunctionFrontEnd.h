#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "libperception/measurement/frames/FrontEnd.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// 3D boxes, in the sensor frame, that a function finds in a frame. Its result depends on the frame
/// alone; any thread may call.
using DetectFunction = std::function<ObjectDetections(const SensorFrame&)>;

/// A front end by a function: what it finds is measured as the boxes of `kind = positions` are, by
/// the same keys of the INI.
class FunctionFrontEnd final : public FrontEnd {
 public:
  FunctionFrontEnd(std::shared_ptr<const DetectFunction> detect,
                   std::unique_ptr<FrontEnd> positions);
  std::vector<std::string> labelNames() const override { return positions_->labelNames(); }

 protected:
  Modality modality() const override { return modality_; }
  std::shared_ptr<const MeasurementModel> model() const override { return model_; }
  void fill(const SensorFrame& frame, MeasurementScan& scan) const override;

 private:
  std::shared_ptr<const DetectFunction> detect_;
  std::unique_ptr<FrontEnd> positions_;
  Modality modality_;
  std::shared_ptr<const MeasurementModel> model_;
};

/// Adds a row to frontEnds(); a second function of that kind replaces the first for the pipelines
/// that are made from then on. Throws Error (kUsage) for a kind that a function did not add.
void addFrontEnd(const std::string& kind, DetectFunction detect);

}  // namespace perception
