#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libperception/simulation/lidar/LidarSensor.h"

namespace perception {

struct Scenario;

/// Labels of phantoms: 110 falling snow as in WADS [kurup2021], and our own numbers for others: 112
/// rain, 113 fog, 114 spray, 115 exhaust, 116 mirror image, 117 noise, 118 dirt on the window. 0
/// for none.
std::uint32_t labelOf(Phantom phantom);

/// What each return of a scan comes from: SemanticKITTI's classes of surfaces (10 car, 18 truck, 20
/// other vehicle, 30 person, 31 cyclist, 40 road, 50 building, 70 vegetation, 80 pole), and
/// phantoms.
std::vector<std::uint32_t> pointLabels(const LidarSensor::Scan& scan, const Scenario& scenario);

/// Labels are by frame number: they exist where one lidar scans once a frame.
bool hasPointLabels(const Scenario& scenario);

/// Name and content (one uint32 a point) of a frame's file in labelFolderOf().
std::string labelFileName(std::int64_t frame);
std::string labelBytes(const std::vector<std::uint32_t>& labels);
/// Removes the labels of an earlier log of this name.
void removeLabels(const std::string& rawlog);

}  // namespace perception
