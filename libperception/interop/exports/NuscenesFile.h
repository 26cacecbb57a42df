#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/scene/files/TrackedRun.h"

namespace perception {

/// The key frames of a log that came from nuScenes, and where its world lies.
struct NuscenesSamples {
  std::vector<std::pair<std::int64_t, std::string>> tokens;  ///< frame number, sample_token
  Pose3 T_global_world = Pose3::Identity();
};

/// FILE.samples.csv beside FILE.rawlog: frame,sample_token and the pose of the log's world in
/// nuScenes' global frame, x,y,z,qw,qx,qy,qz.
std::string samplesFileOf(const std::string& rawlog);
/// Throws OutputError.
void writeNuscenesSamples(const std::string& path, const NuscenesSamples& samples);
/// Throws DataError with file, line and column.
NuscenesSamples readNuscenesSamples(const std::string& path);

/// The result file of nuScenes' tracking benchmark: every sample with the boxes of the run's scene
/// of that frame number, at most 500, those of the greatest scores. `names`: tracking_name of each
/// track; tracks without one are left out. The score of a track is its mean existence. Returns the
/// number of boxes. Throws OutputError.
std::uint64_t writeNuscenesTracks(const std::string& path, const TrackedRun& run,
                                  const std::map<std::uint64_t, std::string>& names,
                                  const NuscenesSamples& samples);

}  // namespace perception
