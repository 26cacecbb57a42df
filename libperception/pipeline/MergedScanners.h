#pragma once
#include <vector>

#include "libperception/pipeline/FrameQueue.h"
#include "libperception/pipeline/PipelineSetup.h"

namespace perception {

/// The frames of one instant, those of scanners that are one sensor (ScanParams::merge) as one
/// frame: scans at most merge_window apart, at the newest one's time. Later scans are taken from
/// the queue before their turn; a merged frame of a later instant goes back into it.
std::vector<SensorFrame> mergeScanners(const std::vector<PipelineSetup::Sensor>& sensors,
                                       std::vector<SensorFrame> frames, FrameQueue& queue);

}  // namespace perception
