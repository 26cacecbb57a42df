#include "libperception/app/ExportApp.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "libperception/interop/FoxgloveMessages.h"
#include "libperception/interop/FoxgloveSchemas.h"
#include "libperception/scene/TrackedRun.h"
#include "libperception/sensors/CameraImages.h"
#include "libperception/sensors/FromObservation.h"
#include "libperception/sensors/RawlogReader.h"

namespace perception {
namespace {

/// Foxglove's channels of one file; those of sensors begin with their first frame.
class FoxgloveFile {
 public:
  FoxgloveFile(const std::string& path, const TrackedRun& run)
      : mcap_(path),
        run_(run),
        tracks_(mcap_.addChannel("/tracks", "json", sceneUpdateSchema())),
        transforms_(mcap_.addChannel("/tf", "json", frameTransformSchema())) {}

  /// Scenes up to the stamp that were not written yet.
  void writeScenes(Stamp until) {
    for (; next_ < run_.scenes.size() && run_.scenes[next_].stamp <= until; ++next_) {
      const Scene& scene = run_.scenes[next_];
      transform(scene.ego.T_world_ego, scene.stamp, "world", "ego");
      mcap_.write(tracks_, scene.stamp, sceneUpdate(scene, run_.class_names, shown_));
    }
  }

  /// False for data without a message of their own: radar, boxes, images that are not there.
  bool writeFrame(const SensorFrame& frame, const EgoState& ego) {
    std::string message;
    const auto* cloud = std::get_if<LidarCloud>(&frame.data);
    const auto* image = std::get_if<CameraImage>(&frame.data);
    if (cloud) message = pointCloud(*cloud, frame.stamp, frame.sensor);
    if (image) {
      const auto raster = image->load ? image->load() : std::nullopt;
      if (raster) message = compressedImage(*raster, frame.stamp, frame.sensor);
    }
    if (message.empty()) return false;
    transform(ego.T_world_ego, frame.stamp, "world", "ego");
    transform(frame.T_ego_sensor, frame.stamp, "ego", frame.sensor);
    auto known = sensors_.find(frame.sensor);
    if (known == sensors_.end()) {
      const auto schema = cloud ? pointCloudSchema() : compressedImageSchema();
      const auto id = mcap_.addChannel("/sensors/" + frame.sensor, "json", schema);
      known = sensors_.emplace(frame.sensor, id).first;
    }
    mcap_.write(known->second, frame.stamp, message);
    return true;
  }

  std::uint64_t close() {
    if (!run_.scenes.empty()) writeScenes(run_.scenes.back().stamp);
    mcap_.close();
    return mcap_.messages();
  }

 private:
  void transform(const Pose3& T, Stamp stamp, const std::string& parent, const std::string& child) {
    mcap_.write(transforms_, stamp, frameTransform(T, stamp, parent, child));
  }

  McapWriter mcap_;
  const TrackedRun& run_;
  std::uint16_t tracks_, transforms_;
  std::map<std::string, std::uint16_t> sensors_;
  std::size_t next_ = 0;
  std::set<std::uint64_t> shown_;
};

}  // namespace

std::string ExportApp::description() const {
  return "Writes a log and its tracks as one MCAP file for viewers of Foxglove's messages.";
}

void ExportApp::declare(CLI::App& cli) {
  addInputOption(cli, true);
  cli.add_option("-r,--run", run_dir, "folder of a run of perception-track on that log")
      ->required()
      ->type_name("DIR");
  addOutputOption(cli, true);
}

void ExportApp::run() {
  if (inputs.size() != 1) throw Error(ExitCode::kUsage, "-i: one log");
  const TrackedRun tracked = readTrackedRun(run_dir);
  RawlogReader reader(inputs.front());
  FoxgloveFile file(output, tracked);
  const std::string images = imagesBeside(inputs.front());
  while (const auto observation = reader.next()) {
    const auto frame = frameFromObservation(*observation, nullptr, images);
    if (!frame) continue;
    file.writeScenes(frame->stamp);
    const auto ego = egoAt(tracked, frame->stamp);
    if (!ego) {
      ++out_without_ego;
    } else if (file.writeFrame(*frame, *ego)) {
      ++out_frames;
    }
  }
  if (out_frames == 0) {
    throw DataError(fmt::format("{}: no lidar scan or image at the times of {}: is it another log?",
                                inputs.front(), run_dir));
  }
  if (reader.end() != RawlogReader::End::kClean) warn(reader.endMessage());
  out_messages = file.close();
  say(1, fmt::format("{}: {} messages, {} scans and images; {} outside the run's scenes left out",
                     output, out_messages, out_frames, out_without_ego));
}

}  // namespace perception
