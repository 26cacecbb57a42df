#include "studies/ResolutionStreams.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

#include "libperception/core/Error.h"
#include "libperception/measurement/CameraResolution.h"
#include "libperception/pipeline/LogRecorder.h"
#include "libperception/pipeline/Pipeline.h"

namespace perception {

/// A sensor set with its tracker; keeps what its front ends found and its scenes.
class ResolutionStreams::Stream : public PipelineObserver {
 public:
  Stream(const ResolutionSite& site, const std::string& letters, int resolution, bool log_odds) {
    run.name = letters;
    run.resolution = resolution;
    run.lidar = letters.find(letterOf(Modality::kLidar)) != std::string::npos;
    Config config = Config::fromFile(site.file);
    const std::string section = "sensor." + site.camera;
    if (resolution >= 0) {
      const char* name = cameraResolutions()[static_cast<std::size_t>(resolution)].name;
      config.set(fmt::format("{}.resolution={}", section, name));
      run.name = fmt::format("C-{}{}", name, letters.substr(1));
    }
    if (log_odds) {
      config.set(section + ".detector.min_score=0");
      config.set(section + ".detector.score_slope=1");
    }
    for (const std::string& setting : site.settings) config.set(setting);
    config.set("run.sensors=" + letters);
    PipelineSetup setup = PipelineSetup::read(config);
    config.finish();
    for (const ObjectClass& c : setup.model.classes.classes)
      run.tracks.class_names.push_back(c.name);
    run.measurements.class_names = run.tracks.class_names;
    pipeline_ = std::make_unique<Pipeline>(std::move(setup), events_, timing_);
    pipeline_->observe(this);
  }

  void onScan(const MeasurementScan& scan) override {
    auto& sensors = run.measurements.sensors;
    const auto known = std::find_if(sensors.begin(), sensors.end(), [&](const RecordedSensor& s) {
      return s.label == scan.sensor;
    });
    const auto index = static_cast<std::size_t>(known - sensors.begin());
    if (known == sensors.end()) sensors.push_back(describeSensor(pipeline_->setup(), scan));
    RecordedScan recorded = recordScan(scan, sensors[index]);
    recorded.sensor = index;
    run.measurements.scans.push_back(std::move(recorded));
  }

  void add(const mrpt::obs::CObservation& observation) {
    pipeline_->add(observation);
    take(false);
  }
  void finish() {
    take(true);
    if (run.tracks.scenes.empty())
      throw DataError(run.name + ": no scene came of it: no frame of its sensors in the log");
    run.tracks.first_stamp = run.measurements.first_stamp = *pipeline_->firstStamp();
  }

  ResolutionRun run;

 private:
  void take(bool flush) {
    while (auto scene = pipeline_->next(flush)) run.tracks.scenes.push_back(std::move(*scene));
  }

  EventLog events_;
  RunTiming timing_;
  std::unique_ptr<Pipeline> pipeline_;
};

ResolutionStreams::ResolutionStreams(const ResolutionSite& site, const std::set<char>& letters,
                                     const std::vector<int>& resolutions, bool log_odds) {
  const std::string radar = letters.count(letterOf(Modality::kRadar)) ? "+R" : "";
  const auto add = [&](const std::string& set, int resolution) {
    streams_.push_back(std::make_unique<Stream>(site, set, resolution, log_odds));
  };
  for (const int r : resolutions) add("C" + radar, r);
  if (!letters.count(letterOf(Modality::kLidar))) return;
  add("L" + radar, -1);
  if (!resolutions.empty()) add("C+L" + radar, resolutions.back());
}

ResolutionStreams::~ResolutionStreams() = default;

void ResolutionStreams::give(const mrpt::obs::CObservation& observation, int resolution) {
  tbb::parallel_for(std::size_t{0}, streams_.size(), [&](std::size_t i) {
    if (resolution >= 0 && streams_[i]->run.resolution != resolution) return;
    // A waiting thread must not start another set: MRPT resamples with the thread's generator.
    tbb::this_task_arena::isolate([&] { streams_[i]->add(observation); });
  });
}

std::vector<ResolutionRun> ResolutionStreams::finish() {
  std::vector<ResolutionRun> runs;
  for (auto& stream : streams_) {
    stream->finish();
    runs.push_back(std::move(stream->run));
  }
  return runs;
}

}  // namespace perception
