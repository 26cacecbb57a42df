#pragma once
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "libperception/scene/Scene.h"

namespace perception {

// Messages of Foxglove's schemas as JSON text. Frames: "world", "ego", and one a sensor with the
// sensor's label; SI units.

/// foxglove.SceneUpdate in frame "world": every object as a cube with its class, id and speed in
/// text and metadata. Objects of `shown` that are not in the scene are deleted; `shown` becomes the
/// ids of the scene. `class_names`: indexed by class_id.
std::string sceneUpdate(const Scene& scene, const std::vector<std::string>& class_names,
                        std::set<std::uint64_t>& shown);
/// The same for readers that may have missed scenes: everything shown before is deleted.
std::string wholeSceneUpdate(const Scene& scene, const std::vector<std::string>& class_names);
/// foxglove.PointCloud: x, y, z and intensity as 32-bit floats, sensor frame; intensity is 0 where
/// the log has none.
std::string pointCloud(const LidarCloud& cloud, Stamp stamp, const std::string& frame_id);
/// foxglove.PointCloud of a radar: x, y, z, range_rate (NaN where unknown) and amplitude.
std::string pointCloud(const RadarReturns& radar, Stamp stamp, const std::string& frame_id);
/// foxglove.FrameTransform: p_parent = T p_child.
std::string frameTransform(const Pose3& T, Stamp stamp, const std::string& parent,
                           const std::string& child);
/// foxglove.Log; `warning`: its level, else that of information.
std::string logMessage(Stamp stamp, bool warning, const std::string& name,
                       const std::string& message);
/// Values over time, for plots: numbersSchema(). Those that are not finite are left out.
std::string numbersMessage(Stamp stamp, const std::map<std::string, double>& values);
/// foxglove.CompressedImage as JPEG; the frame is the camera's optical one.
std::string compressedImage(const Raster& raster, Stamp stamp, const std::string& frame_id);

}  // namespace perception
