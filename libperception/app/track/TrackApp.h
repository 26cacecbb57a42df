#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libperception/app/App.h"
#include "libperception/live/LiveView.h"
#include "libperception/pipeline/Pipeline.h"
#include "libperception/scene/files/KittiExport.h"
#include "libperception/sensors/rawlog/FileSink.h"
#include "libperception/sensors/rawlog/ObservationInput.h"

namespace perception {

/// perception-track: from rawlogs, or sensors at work, to tracked and classified objects.
class TrackApp : public App {
 public:
  TrackApp()
      : App("perception-track",
            "Tracks and classifies the objects around a vehicle, from rawlogs or from live "
            "sensors") {}

  std::string sensors;                ///< --sensors: overrides [run] sensors
  std::optional<std::uint64_t> seed;  ///< --seed: overrides [run] seed
  double rate = 0;                    ///< --rate [Hz]: scenes at a fixed rate instead of at scans
  std::vector<std::string> exports;   ///< --export FORMAT:FILE
  bool measurements = false;          ///< --measurements: also record the filter's input
  double duration = 0;                ///< --duration [s]: of sensors at work; 0: until a signal
  std::string record;                 ///< --record: folder; sensors at work are recorded, too
  std::string publish;                ///< --publish INTERFACE[:DOMAIN]: scenes by DDS
  ServeOptions serve;                 ///< --serve and what belongs to it
  bool overwrite = false;             ///< --overwrite: replace the results of another run
  bool info = false;                  ///< --info: say what the logs hold and stop
  bool keep_scenes = false;           ///< keep all scenes in out_scenes (tests)

  void declare(CLI::App& cli) override;
  void run() override;

  std::vector<Scene> out_scenes;    ///< of the last log, with keep_scenes
  RunRecord out_record;             ///< of the last log
  double out_real_time_factor = 0;  ///< seconds of log per second of work, last log

 private:
  /// One log and its result folder.
  struct Shard {
    std::string log, dir, export_file, effective_ini, configuration_hash;
    std::string hash;  ///< hashOfRun(); empty: of a new run, and known when its log is read
  };
  /// Those that are left to do.
  std::vector<Shard> shards(const std::string& effective_ini);
  void trackLog(const PipelineSetup& setup, const Shard& shard);
  void declareServe(CLI::App& cli);
  void checkInputs() const;
  int threadCount() const;
  std::unique_ptr<ObservationInput> openInput(const std::string& log, FileSink sink) const;
  void printContents(const std::string& log);
  Config configWithOptions() const;
  std::string exportFileFor(const std::string& log) const;
};

}  // namespace perception
