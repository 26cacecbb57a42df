#include "studies/resolution/SensorSetRun.h"

#include <algorithm>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/pipeline/input/LogRecorder.h"

namespace perception {

SensorSetRun::SensorSetRun(std::string name, Config& config) : name_(std::move(name)) {
  PipelineSetup setup = PipelineSetup::read(config);
  config.finish();
  for (const ObjectClass& c : setup.model.classes.classes) tracks.class_names.push_back(c.name);
  measurements.class_names = tracks.class_names;
  pipeline_ = std::make_unique<Pipeline>(std::move(setup), events_, timing_);
  pipeline_->observe(this);
}

void SensorSetRun::onScan(const MeasurementScan& scan) {
  auto& sensors = measurements.sensors;
  const auto known = std::find_if(sensors.begin(), sensors.end(),
                                  [&](const RecordedSensor& s) { return s.label == scan.sensor; });
  const auto index = static_cast<std::size_t>(known - sensors.begin());
  if (known == sensors.end()) sensors.push_back(describeSensor(pipeline_->setup(), scan));
  RecordedScan recorded = recordScan(scan, sensors[index]);
  recorded.sensor = index;
  measurements.scans.push_back(std::move(recorded));
}

void SensorSetRun::add(const mrpt::obs::CObservation& observation) {
  pipeline_->add(observation);
  take(false);
}

void SensorSetRun::finish() {
  take(true);
  if (tracks.scenes.empty())
    throw DataError(name_ + ": no scene came of it: no frame of its sensors in the log");
  tracks.first_stamp = measurements.first_stamp = *pipeline_->firstStamp();
}

void SensorSetRun::take(bool flush) {
  while (auto scene = pipeline_->next(flush)) tracks.scenes.push_back(std::move(*scene));
}

const PipelineSetup::Sensor* sensorInUse(const PipelineSetup& site, const std::string& label) {
  for (const auto& s : site.sensors) {
    if (s.active && (s.label == label || s.scan.merges(label))) return &s;
  }
  return nullptr;
}

GroundTruth truthByInstant(const std::vector<TruthObject>& rows) {
  GroundTruth truth;
  for (const TruthObject& row : rows) {
    if (truth.instants.empty() || truth.instants.back().frame != row.frame)
      truth.instants.push_back({row.frame, row.t, {}});
    truth.instants.back().objects.push_back(row);
  }
  return truth;
}

}  // namespace perception
