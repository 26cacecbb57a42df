#include "libperception/python/extensions/FunctionFrontEnd.h"

#include <algorithm>
#include <map>
#include <utility>

#include "libperception/boxes3d/PositionFrontEnd.h"
#include "libperception/core/Error.h"
#include "libperception/pipeline/PipelineSetup.h"

namespace perception {
namespace {

using DetectFunctions = std::map<std::string, std::shared_ptr<const DetectFunction>>;

/// By kind. Never destroyed: a function of Python must not outlive Python.
DetectFunctions& detectFunctions() {
  static auto* const functions = new DetectFunctions;
  return *functions;
}

std::unique_ptr<FrontEnd> makeFunctionFrontEnd(Config& config, const std::string& label,
                                               const ClassTable& classes) {
  const std::string section = "sensor." + label;
  const auto kind = config.read<DetectionParams>(section).kind;
  const auto positions = config.read<PositionParams>(section + ".positions");
  if (positions.confidence == PositionParams::Confidence::kLearnt)
    config.fault(section + ".positions", "confidence",
                 "learnt: of kind = positions alone, not of a function");
  return std::make_unique<FunctionFrontEnd>(detectFunctions().at(kind),
                                            makePositionFrontEnd(config, label, classes));
}

}  // namespace

FunctionFrontEnd::FunctionFrontEnd(std::shared_ptr<const DetectFunction> detect,
                                   std::unique_ptr<FrontEnd> positions)
    : detect_(std::move(detect)), positions_(std::move(positions)) {
  SensorFrame nothing;
  nothing.data.emplace<ObjectDetections>();
  const MeasurementScan scan = positions_->extract(nothing);
  modality_ = scan.modality;
  model_ = scan.model;
}

void FunctionFrontEnd::fill(const SensorFrame& frame, MeasurementScan& scan) const {
  SensorFrame found;
  found.sensor = frame.sensor;
  found.stamp = frame.stamp;
  found.ego = frame.ego;
  found.T_ego_sensor = frame.T_ego_sensor;
  found.data = (*detect_)(frame);
  MeasurementScan boxes = positions_->extract(found);
  scan.measurements = std::move(boxes.measurements);
  scan.dropped += boxes.dropped;
}

void addFrontEnd(const std::string& kind, DetectFunction detect) {
  auto& rows = frontEnds();
  const bool known = std::any_of(rows.begin(), rows.end(),
                                 [&](const FrontEndRow& row) { return row.kind == kind; });
  if (kind.empty() || (known && detectFunctions().count(kind) == 0))
    throw Error(ExitCode::kUsage, "front end '" + kind + "': there is one of this name already");
  detectFunctions()[kind] = std::make_shared<const DetectFunction>(std::move(detect));
  if (!known) rows.push_back({kind, &makeFunctionFrontEnd});
}

}  // namespace perception
