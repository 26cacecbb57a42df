#include "libperception/pipeline/LogRecorder.h"

#include <mrpt/obs/CObservationComment.h>

#include <algorithm>
#include <filesystem>

#include "libperception/core/Error.h"
#include "libperception/pipeline/Progress.h"
#include "libperception/sensors/RawlogReader.h"
#include "libperception/sensors/registerClasses.h"

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

RecordedLog recordLog(const std::string& log, Config& config, double seconds,
                      const ObservationEdit& edit) {
  registerPerceptionClasses();
  PipelineSetup setup = PipelineSetup::read(config);
  config.finish();
  setup.run.output_lag = setup.model.history = 0;  // replays are causal
  RecordedLog recorded;
  recorded.name = std::filesystem::path(log).stem().string();
  recorded.model = setup.model;
  recorded.particles = setup.particles;
  recorded.scene = setup.scene;
  // The tracks are not used: cheapest settings.
  if (!setup.model.params.sampled_births) setup.model.proposal = Proposal::kNearest;
  setup.particles.sample_size = 1;

  EventLog events;
  RunTiming timing;
  Pipeline pipeline(setup, events, timing);
  Recorder recorder(recorded);
  pipeline.observe(&recorder);
  RawlogReader reader(log);
  while (const auto observation = reader.next()) {
    stopIfAsked();
    const auto* comment = dynamic_cast<const mrpt::obs::CObservationComment*>(observation.get());
    if (comment && comment->text.rfind("simulated log", 0) == 0) recorded.simulated = true;
    const auto first = pipeline.firstStamp();
    if (seconds > 0 && first && pipeline.lastStamp() - *first > seconds) break;
    if (edit) edit(*observation);
    pipeline.add(*observation);
    while (pipeline.next()) {
    }
  }
  while (pipeline.next(true)) {
  }
  const bool any =
      std::any_of(recorded.entries.begin(), recorded.entries.end(),
                  [](const RecordedLog::Entry& e) { return e.kind == RecordedLog::Entry::kScene; });
  if (!any)
    throw DataError(log + ": no scene came of it: the log holds no frame of a sensor in use");
  recorded.first_stamp = *pipeline.firstStamp();
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
