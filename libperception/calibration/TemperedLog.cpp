#include "libperception/calibration/TemperedLog.h"

#include <map>
#include <memory>
#include <utility>

#include "libperception/measurement/models/ForwardedModel.h"

namespace perception {
namespace {

/// A sensor's model with other exponents, in place of what tells how its errors repeat.
class TemperedModel final : public ForwardedModel {
 public:
  TemperedModel(std::shared_ptr<const MeasurementModel> model, Exponents::OfSensor exponents)
      : ForwardedModel(std::move(model)), exponents_(std::move(exponents)) {}

  const PositionOnlyModel* positionOnly() const override { return nullptr; }
  double labelExponent() const override { return exponents_.label; }
  double detectionExponent() const override { return exponents_.detection; }
  double innovationShare() const override { return 1; }
  double aloneInnovationShare() const override { return 1; }
  const EvidenceMemory* evidenceMemory() const override { return nullptr; }
  const EvidenceMemory* lookMemory() const override { return nullptr; }

 private:
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
