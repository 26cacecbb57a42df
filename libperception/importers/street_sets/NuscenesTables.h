#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/core/Time.h"

namespace perception {

/// A drive of 20 s: a row of scene.json.
struct NuscenesScene {
  std::string token, name, description;
  std::int64_t samples = 0;  ///< key frames, two a second
};

/// A sensor on the vehicle: rows of calibrated_sensor.json and sensor.json.
struct NuscenesSensor {
  std::string channel;   ///< LIDAR_TOP, RADAR_FRONT, CAM_BACK_LEFT ...
  std::string modality;  ///< lidar, radar, camera
  /// The vehicle's frame: on the ground below the middle of the rear axle.
  Pose3 T_ego_sensor = Pose3::Identity();
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< [px] of a camera, whose images are rectified
};

/// What a sensor said at one instant: a row of sample_data.json.
struct NuscenesData {
  std::size_t sensor = 0;  ///< of NuscenesDrive::sensors
  Stamp stamp;
  std::int64_t sample =
      0;             ///< number of its key frame in the scene, for what lies between the next
  bool key = false;  ///< of a key frame, which has truth
  std::string file;  ///< below the data set's folder
  Pose3 T_global_ego = Pose3::Identity();  ///< z is 0 everywhere
};

/// A box of the truth; `object` stands in the global frame.
struct NuscenesBox {
  std::int64_t sample = 0;
  TruthObject object;
};

/// One scene with all that its tables say.
struct NuscenesDrive {
  std::vector<NuscenesSensor> sensors;
  std::vector<NuscenesData> data;          ///< in order of time
  std::vector<Stamp> samples;              ///< of the key frames
  std::vector<std::string> sample_tokens;  ///< of the same
  std::vector<NuscenesBox> boxes;          ///< of the test set: none
};

/// The scenes of a folder of tables (ROOT/v1.0-mini). Throws DataError: kNoInput where a table is
/// missing, else with file, row and member.
std::vector<NuscenesScene> readNuscenesScenes(const std::string& tables);

/// Reads the tables once, row by row: what belongs to other scenes takes no memory.
NuscenesDrive readNuscenesDrive(const std::string& tables, const NuscenesScene& scene);

/// The truth's type for a category (vehicle.bus.rigid) with its attributes: KITTI's words where
/// there are some; a bicycle is a Cyclist with a rider, else a Bicycle.
std::string nuscenesTypeOf(const std::string& category, const std::vector<std::string>& attributes);

}  // namespace perception
