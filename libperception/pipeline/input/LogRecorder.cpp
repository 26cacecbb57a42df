#include "libperception/pipeline/input/LogRecorder.h"

#include <mrpt/obs/CObservationComment.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/pipeline/input/LogContents.h"
#include "libperception/pipeline/output/Progress.h"
#include "libperception/sensors/observations/registerClasses.h"
#include "libperception/sensors/rawlog/RawlogReader.h"

namespace perception {
namespace {

// Records all scans and scenes.
class Recorder : public PipelineObserver {
 public:
  explicit Recorder(RecordedLog& log) : log_(log) {}

  void onScan(const MeasurementScan& scan) override {
    RecordedLog::Entry entry;
    entry.scan = std::make_shared<const MeasurementScan>(scan);
    log_.entries.push_back(std::move(entry));
  }
  void onScene(const EgoState& ego, std::int64_t frame) override {
    log_.entries.push_back({RecordedLog::Entry::kScene, nullptr, ego, frame});
  }
  void onRestart() override {
    log_.entries.push_back({RecordedLog::Entry::kRestart, nullptr, {}, -1});
  }

 private:
  RecordedLog& log_;
};

}  // namespace

PipelineSetup forFrontEnds(PipelineSetup setup) {
  if (!setup.model.params.sampled_births) setup.model.proposal = Proposal::kNearest;
  setup.particles.sample_size = 1;
  setup.grid.enabled = false;
  return setup;
}

LogPass passLog(const std::string& log, PipelineSetup setup, double seconds,
                PipelineObserver& observer, const ObservationEdit& edit) {
  registerPerceptionClasses();
  LogPass pass;
  EventLog events;
  RunTiming timing;
  Pipeline pipeline(std::move(setup), events, timing);
  pipeline.observe(&observer);
  RawlogReader reader(log);
  while (const auto observation = reader.next()) {
    stopIfAsked();
    const auto* comment = dynamic_cast<const mrpt::obs::CObservationComment*>(observation.get());
    if (comment && comment->text.rfind("simulated log", 0) == 0) pass.simulated = true;
    const auto first = pipeline.firstStamp();
    if (seconds > 0 && first && pipeline.lastStamp() - *first > seconds) break;
    if (edit) edit(*observation);
    pipeline.add(*observation);
    while (pipeline.next()) {
    }
    for (const WeatherRow& row : pipeline.takeWeather()) observer.onWeather(row);
    pipeline.takeLedger();  // not used here, and must not pile up
  }
  while (pipeline.next(true)) {
  }
  for (const WeatherRow& row : pipeline.takeWeather()) observer.onWeather(row);
  pass.first_stamp = pipeline.firstStamp();
  return pass;
}

RecordedLog recordLog(const std::string& log, Config& config, double seconds,
                      const ObservationEdit& edit) {
  PipelineSetup setup = PipelineSetup::read(config);
  config.finish();
  setup.run.output_lag = setup.model.history = 0;  // replays are causal
  RecordedLog recorded;
  recorded.name = std::filesystem::path(log).stem().string();
  recorded.model = setup.model;
  recorded.particles = setup.particles;
  recorded.scene = setup.scene;
  Recorder recorder(recorded);
  const PipelineSetup wanted = setup;
  setup.grid.enabled = false;
  const LogPass pass = passLog(log, std::move(setup), seconds, recorder, edit);
  recorded.simulated = pass.simulated;
  const bool any =
      std::any_of(recorded.entries.begin(), recorded.entries.end(),
                  [](const RecordedLog::Entry& e) { return e.kind == RecordedLog::Entry::kScene; });
  if (!any) {
    LogContents contents;
    RawlogReader reader(log);
    while (const auto observation = reader.next()) contents.look(*observation);
    throw DataError(noSceneMessage(log, contents, wanted, reader.endMessage()));
  }
  recorded.first_stamp = *pass.first_stamp;
  return recorded;
}

RecordedSensor describeSensor(const PipelineSetup& setup, const MeasurementScan& scan) {
  RecordedSensor sensor;
  for (const auto& s : setup.sensors) {
    if (s.label != scan.sensor) continue;
    sensor = describeSensor(scan, s.front_end->labelNames(), s.params.fov, s.params.range_min,
                            s.params.range_max, setup.model.classes.size());
  }
  return sensor;
}

}  // namespace perception
