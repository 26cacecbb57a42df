#include "libperception/pipeline/input/MergedScanners.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace perception {

std::vector<SensorFrame> mergeScanners(
    const std::vector<PipelineSetup::Sensor>& sensors, std::vector<SensorFrame> frames,
    FrameQueue& queue, const std::function<void(std::size_t, const SensorFrame&)>& on_part) {
  if (frames.empty()) return frames;
  const Stamp stamp = frames.front().stamp;
  for (std::size_t k = 0; k < sensors.size(); ++k) {
    const auto& sensor = sensors[k];
    const auto others =
        std::stable_partition(frames.begin(), frames.end(), [&](const SensorFrame& f) {
          return f.sensor == sensor.label || !sensor.scan.merges(f.sensor);
        });
    if (others == frames.end()) continue;
    std::vector<SensorFrame> scans(std::make_move_iterator(others),
                                   std::make_move_iterator(frames.end()));
    frames.erase(others, frames.end());
    const auto missing = [&](const std::string& label) {
      return sensor.scan.merges(label) &&
             std::none_of(scans.begin(), scans.end(),
                          [&](const SensorFrame& f) { return f.sensor == label; });
    };
    for (auto& scan : queue.take(stamp + sensor.scan.merge_window, missing)) {
      if (missing(scan.sensor)) scans.push_back(std::move(scan));
    }
    std::sort(scans.begin(), scans.end(),
              [](const SensorFrame& a, const SensorFrame& b) { return a.sensor < b.sensor; });
    for (const SensorFrame& scan : scans) on_part(k, scan);
    SensorFrame merged = mergedScan(scans, sensor.label);
    if (merged.stamp == stamp) {
      frames.push_back(std::move(merged));
    } else {
      queue.push(std::move(merged));
    }
  }
  return frames;
}

}  // namespace perception
