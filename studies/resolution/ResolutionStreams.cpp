#include "studies/resolution/ResolutionStreams.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <utility>

#include "libperception/measurement/models/CameraResolution.h"
#include "studies/resolution/SensorSetRun.h"

namespace perception {

/// A sensor set with its tracker.
class ResolutionStreams::Stream {
 public:
  Stream(const ResolutionSite& site, const std::string& letters, int resolution) {
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
    for (const std::string& setting : site.settings) config.set(setting);
    config.set("run.sensors=" + letters);
    kept_ = std::make_unique<SensorSetRun>(run.name, config);
  }

  void add(const mrpt::obs::CObservation& observation) { kept_->add(observation); }
  void finish() {
    kept_->finish();
    run.tracks = std::move(kept_->tracks);
    run.measurements = std::move(kept_->measurements);
  }

  ResolutionRun run;

 private:
  std::unique_ptr<SensorSetRun> kept_;
};

ResolutionStreams::ResolutionStreams(const ResolutionSite& site, const std::set<char>& letters,
                                     const std::vector<int>& resolutions) {
  const std::string radar = letters.count(letterOf(Modality::kRadar)) ? "+R" : "";
  const auto add = [&](const std::string& set, int resolution) {
    streams_.push_back(std::make_unique<Stream>(site, set, resolution));
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
