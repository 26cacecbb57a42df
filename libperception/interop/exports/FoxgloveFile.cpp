#include <map>
#include <set>

#include "libperception/interop/exports/ExportFile.h"
#include "libperception/interop/exports/FoxgloveMessages.h"
#include "libperception/interop/exports/FoxgloveSchemas.h"

namespace perception {
namespace {

/// Channels of sensors begin with their first frame.
class FoxgloveFile final : public ExportFile {
 public:
  FoxgloveFile(const std::string& path, const std::vector<std::string>& class_names,
               const std::string& mark)
      : mcap_(path),
        class_names_(class_names),
        tracks_(mcap_.addChannel("/tracks", "json", sceneUpdateSchema(), {{"run", mark}})),
        transforms_(mcap_.addChannel("/tf", "json", frameTransformSchema())) {}

  // Every scene and frame has a transform of its own.
  void writePose(Stamp, const Pose3&) override {}

  void writeScene(const Scene& scene) override {
    transform(scene.ego.T_world_ego, scene.stamp, "world", "ego");
    mcap_.write(tracks_, scene.stamp, sceneUpdate(scene, class_names_, shown_));
  }

  bool writeFrame(const SensorFrame& frame) override {
    std::string message;
    const auto* cloud = std::get_if<LidarCloud>(&frame.data);
    const auto* image = std::get_if<CameraImage>(&frame.data);
    const auto* radar = std::get_if<RadarReturns>(&frame.data);
    if (cloud) message = pointCloud(*cloud, frame.stamp, frame.sensor);
    if (radar) message = pointCloud(*radar, frame.stamp, frame.sensor);
    if (image) {
      const auto raster = image->load ? image->load() : std::nullopt;
      if (raster) message = compressedImage(*raster, frame.stamp, frame.sensor);
    }
    if (message.empty()) return false;
    transform(frame.ego.T_world_ego, frame.stamp, "world", "ego");
    transform(frame.T_ego_sensor, frame.stamp, "ego", frame.sensor);
    auto known = sensors_.find(frame.sensor);
    if (known == sensors_.end()) {
      const auto schema = image ? compressedImageSchema() : pointCloudSchema();
      const auto id = mcap_.addChannel("/sensors/" + frame.sensor, "json", schema);
      known = sensors_.emplace(frame.sensor, id).first;
    }
    mcap_.write(known->second, frame.stamp, message);
    return true;
  }

  std::uint64_t close() override {
    mcap_.close();
    return mcap_.messages();
  }

 private:
  void transform(const Pose3& T, Stamp stamp, const std::string& parent, const std::string& child) {
    mcap_.write(transforms_, stamp, frameTransform(T, stamp, parent, child));
  }

  McapWriter mcap_;
  const std::vector<std::string> class_names_;
  std::uint16_t tracks_, transforms_;
  std::map<std::string, std::uint16_t> sensors_;
  std::set<std::uint64_t> shown_;
};

}  // namespace

std::unique_ptr<ExportFile> makeFoxgloveFile(const std::string& path,
                                             const std::vector<std::string>& class_names,
                                             const std::string& mark) {
  return std::make_unique<FoxgloveFile>(path, class_names, mark);
}

}  // namespace perception
