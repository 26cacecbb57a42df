#include "libperception/calibration/TemperedLog.h"

#include <map>
#include <memory>
#include <utility>

#include "libperception/measurement/MeasurementModel.h"

namespace perception {
namespace {

/// A sensor's model with other exponents.
class TemperedModel final : public MeasurementModel {
 public:
  TemperedModel(std::shared_ptr<const MeasurementModel> model, Exponents::OfSensor exponents)
      : model_(std::move(model)), exponents_(std::move(exponents)) {}

  const std::vector<AxisKind>& axes() const override { return model_->axes(); }
  AxisMask extentAxes() const override { return model_->extentAxes(); }
  void predict(const Kinematics* objects, const Extent* extents, std::size_t count,
               const SensorState& sensor, AxisPrediction* out) const override {
    model_->predict(objects, extents, count, sensor, out);
  }
  AspectLine aspectLine() const override { return model_->aspectLine(); }
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
  double labelExponent() const override { return exponents_.label; }
  double detectionExponent() const override { return exponents_.detection; }
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

 private:
  std::shared_ptr<const MeasurementModel> model_;
  Exponents::OfSensor exponents_;
};

}  // namespace

Exponents exponentsOf(const RecordedLog& log) {
  std::map<std::string, Exponents::OfSensor> sensors;  // whose labels depend on the class
  for (const auto& entry : log.entries) {
    if (entry.kind != RecordedLog::Entry::kScan || sensors.count(entry.scan->sensor)) continue;
    const MeasurementModel& model = *entry.scan->model;
    for (const Measurement& m : entry.scan->measurements) {
      bool tells = false;
      for (ClassId c = 1; c < log.model.classes.size(); ++c)
        tells = tells || logLabelOf(model, m, c) != logLabelOf(model, m, 0);
      if (!tells) continue;
      sensors[entry.scan->sensor] = {entry.scan->sensor, model.labelExponent(),
                                     model.detectionExponent()};
      break;
    }
  }
  Exponents out;
  out.kinematic = log.model.params.kinematic_exponent;
  for (auto& [name, sensor] : sensors) out.sensors.push_back(std::move(sensor));
  return out;
}

RecordedLog withExponents(const RecordedLog& log, const Exponents& exponents) {
  RecordedLog out = log;
  out.model.params.kinematic_exponent = exponents.kinematic;
  for (auto& entry : out.entries) {
    if (entry.kind != RecordedLog::Entry::kScan) continue;
    for (const auto& s : exponents.sensors) {
      if (s.sensor != entry.scan->sensor) continue;
      auto scan = std::make_shared<MeasurementScan>(*entry.scan);
      scan->model = std::make_shared<const TemperedModel>(entry.scan->model, s);
      entry.scan = std::move(scan);
      break;
    }
  }
  return out;
}

}  // namespace perception
