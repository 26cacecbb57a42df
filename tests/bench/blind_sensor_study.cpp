// A copy of a rawlog in which one sensor sees nothing, or a share of what it saw, from an instant
// on: blind_sensor_study IN OUT LABEL FROM SHARE. FROM [s] after the first stamp; SHARE in [0, 1]
// of its returns, targets or boxes is kept, by chance. To be tracked: does the run name the sensor?
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "libperception/core/Random.h"
#include "libperception/sensors/CObservationLidarScan.h"
#include "libperception/sensors/CObservationObjectDetections.h"
#include "libperception/sensors/CObservationRadarScan.h"
#include "libperception/sensors/Conversions.h"
#include "libperception/sensors/RawlogReader.h"
#include "libperception/sensors/RawlogWriter.h"
#include "libperception/sensors/registerClasses.h"

namespace perception {
namespace {

template <class T>
void thin(std::vector<T>& values, double share, std::uint64_t frame) {
  Rng rng({7, frame, 0, 0});
  std::vector<T> kept;
  for (T& value : values)
    if (rng.uniform() < share) kept.push_back(std::move(value));
  values = std::move(kept);
}

void blind(mrpt::obs::CObservation& observation, double share, std::uint64_t frame) {
  if (auto* radar = dynamic_cast<CObservationRadarScan*>(&observation))
    thin(radar->scan.returns, share, frame);
  if (auto* boxes = dynamic_cast<CObservationObjectDetections*>(&observation))
    thin(boxes->detections.objects, share, frame);
  auto* lidar = dynamic_cast<CObservationLidarScan*>(&observation);
  if (lidar == nullptr) return;
  LidarCloud& c = lidar->cloud;
  // The same seed for all of them keeps the same returns.
  thin(c.x, share, frame), thin(c.y, share, frame), thin(c.z, share, frame);
  thin(c.intensity, share, frame), thin(c.ring, share, frame), thin(c.time_offset, share, frame);
  thin(c.echo, share, frame), thin(c.pulse_width, share, frame), thin(c.label, share, frame);
  thin(c.trust, share, frame);
}

int run(char** argv) {
  registerPerceptionClasses();
  RawlogReader in(argv[1]);
  RawlogWriter out(argv[2]);
  const std::string label = argv[3];
  const double from = std::atof(argv[4]), share = std::atof(argv[5]);
  std::optional<Stamp> first;
  std::uint64_t frame = 0;
  while (const auto observation = in.next()) {
    const auto stamp = toStamp(observation->timestamp);
    if (stamp && !first) first = stamp;
    if (stamp && *stamp - *first >= from && observation->sensorLabel == label)
      blind(*observation, share, ++frame);
    out.write(*observation);
  }
  out.close();
  std::printf("%llu frames of %s\n", static_cast<unsigned long long>(frame), label.c_str());
  return frame > 0 ? 0 : 1;
}

}  // namespace
}  // namespace perception

int main(int argc, char** argv) {
  if (argc != 6) {
    std::fprintf(stderr, "usage: blind_sensor_study IN OUT LABEL FROM SHARE\n");
    return 64;
  }
  try {
    return perception::run(argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
