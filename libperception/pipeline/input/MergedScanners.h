#pragma once
#include <functional>
#include <vector>

#include "libperception/pipeline/PipelineSetup.h"
#include "libperception/pipeline/input/FrameQueue.h"

namespace perception {

/// Merges the frames of scanners that form one sensor (ScanParams::merge) into one frame: scans at
/// most merge_window apart, at the stamp of the newest. Later scans are taken from the queue early;
/// a merged frame with a later stamp is put back into it. `on_part` is called with every scan
/// before it is merged, and the index of its sensor.
std::vector<SensorFrame> mergeScanners(
    const std::vector<PipelineSetup::Sensor>& sensors, std::vector<SensorFrame> frames,
    FrameQueue& queue,
    const std::function<void(std::size_t, const SensorFrame&)>& on_part =
        [](std::size_t, const SensorFrame&) {});

}  // namespace perception
