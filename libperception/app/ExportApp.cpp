#include "libperception/app/ExportApp.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "libperception/app/Programs.h"
#include "libperception/evaluation/metrics/TrackingBenchmark.h"
#include "libperception/interop/exports/ExportFile.h"
#include "libperception/interop/exports/NuscenesFile.h"
#include "libperception/pipeline/output/FinishedRun.h"
#include "libperception/scene/files/TrackedRun.h"
#include "libperception/sensors/ego/EgoPose.h"
#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/sensors/images/CameraImages.h"
#include "libperception/sensors/rawlog/RawlogReader.h"

namespace perception {
namespace {

/// The scenes of a run up to the last instant that was asked for.
class SceneWriter {
 public:
  SceneWriter(const TrackedRun& run, ExportFile& file) : run_(run), file_(file) {}
  void writeUntil(Stamp stamp) {
    for (; next_ < run_.scenes.size() && run_.scenes[next_].stamp <= stamp; ++next_)
      file_.writeScene(run_.scenes[next_]);
  }
  void writeRest() {
    if (!run_.scenes.empty()) writeUntil(run_.scenes.back().stamp);
  }

 private:
  const TrackedRun& run_;
  ExportFile& file_;
  std::size_t next_ = 0;
};

}  // namespace

void ExportApp::declare(CLI::App& cli) {
  addInputOption(cli, true);
  cli.get_option("--input")->expected(1);
  cli.add_option("-r,--run", run_dir, "folder of a run of perception-track on that log")
      ->type_name("DIR");
  cli.add_option("--format", format,
                 "foxglove: Foxglove's messages in JSON; ros2: ROS 2 messages in CDR, which "
                 "perception-import bag reads back; without -r the log alone; nuscenes: the "
                 "result file of its tracking benchmark, of a log of perception-import nuscenes")
      ->check(CLI::IsMember({"foxglove", "ros2", "nuscenes"}))
      ->capture_default_str();
  addOutputOption(cli, true);
}

void ExportApp::run() {
  if (inputs.size() != 1) throw Error(ExitCode::kUsage, "-i: one log");
  if (format == "nuscenes") return writeTracks();
  const bool ros = format == "ros2";
  if (run_dir.empty() && !ros) throw Error(ExitCode::kUsage, "-r/--run is needed for foxglove");
  const TrackedRun tracked = run_dir.empty() ? TrackedRun{} : readTrackedRun(run_dir);
  const std::string mark = markOfRuns({run_dir});
  RawlogReader reader(inputs.front());
  const auto file = ros ? makeRosFile(output, tracked.class_names, mark)
                        : makeFoxgloveFile(output, tracked.class_names, mark);
  SceneWriter scenes(tracked, *file);
  std::string poses_of;  // a log may hold those of several estimators
  const std::string images = imagesBeside(inputs.front());
  while (const auto observation = reader.next()) {
    if (const auto pose = loggedPose(*observation)) {
      if (poses_of.empty()) poses_of = observation->sensorLabel;
      if (poses_of == observation->sensorLabel) file->writePose(pose->stamp, pose->T_world_ego);
    }
    auto frame = frameFromObservation(*observation, nullptr, images);
    if (!frame) continue;
    scenes.writeUntil(frame->stamp);
    const auto ego = egoAt(tracked, frame->stamp);
    if (ego) frame->ego = *ego;
    if (!ego && !run_dir.empty()) {
      ++out_without_ego;
    } else if (file->writeFrame(*frame)) {
      ++out_frames;
    }
  }
  if (out_frames == 0) {
    throw DataError(
        fmt::format("{}: no scan or image{}", inputs.front(),
                    run_dir.empty() ? "" : " at the times of " + run_dir + ": is it another log?"));
  }
  if (reader.end() != RawlogReader::End::kClean) warn(reader.endMessage());
  scenes.writeRest();
  out_messages = file->close();
  say(1, fmt::format("{}: {} messages, {} scans and images; {} outside the run's scenes left out",
                     output, out_messages, out_frames, out_without_ego));
}

/// Tracks alone, at the key frames of the data set that the log was imported from.
void ExportApp::writeTracks() {
  if (run_dir.empty()) throw Error(ExitCode::kUsage, "-r/--run is needed for nuscenes");
  const std::string file = samplesFileOf(inputs.front());
  if (!std::filesystem::exists(file))
    throw DataError(file + ": not found; perception-import nuscenes writes it beside the log",
                    ExitCode::kNoInput);
  const TrackedRun tracked = readTrackedRun(run_dir);
  const NuscenesSamples samples = readNuscenesSamples(file);
  out_messages = writeNuscenesTracks(output, tracked, benchmarkNamesOf(tracked), samples);
  say(1, fmt::format("{}: {} boxes in {} samples", output, out_messages, samples.tokens.size()));
}

std::unique_ptr<App> exportApp() { return std::make_unique<ExportApp>(); }

}  // namespace perception
