#include "libperception/simulation/lidar/PointTruth.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "libperception/core/GroundTruth.h"
#include "libperception/simulation/world/Scenario.h"

namespace perception {
namespace {

std::uint32_t pointLabelOf(ObjectKind kind) {
  switch (kind) {
    case ObjectKind::kCar:
      return 10;
    case ObjectKind::kBus:
      return 18;
    case ObjectKind::kVan:
      return 20;
    case ObjectKind::kPedestrian:
      return 30;
    case ObjectKind::kCyclist:
      return 31;
    case ObjectKind::kBox:
      return 50;
    case ObjectKind::kBush:
      return 70;
    case ObjectKind::kPole:
      return 80;
  }
  return 0;
}

constexpr std::uint32_t kRoadLabel = 40;

}  // namespace

std::uint32_t labelOf(Phantom phantom) {
  switch (phantom) {
    case Phantom::kNone:
      return 0;
    case Phantom::kSnow:
      return 110;
    case Phantom::kRain:
      return 112;
    case Phantom::kFog:
      return 113;
    case Phantom::kSpray:
      return 114;
    case Phantom::kPlume:
      return 115;
    case Phantom::kMirror:
      return 116;
    case Phantom::kNoise:
      return 117;
    case Phantom::kDirt:
      return 118;
  }
  return 0;
}

std::vector<std::uint32_t> pointLabels(const LidarSensor::Scan& scan, const Scenario& scenario) {
  std::vector<std::uint32_t> labels(scan.surfaces.size(), kRoadLabel);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const int object = scan.surfaces[i];
    const Phantom phantom = scan.phantoms.empty() ? Phantom::kNone : scan.phantoms[i];
    if (phantom != Phantom::kNone) {
      labels[i] = labelOf(phantom);
    } else if (object >= 0) {
      labels[i] = pointLabelOf(scenario.objects[static_cast<std::size_t>(object)].kind);
    }
  }
  return labels;
}

bool hasPointLabels(const Scenario& scenario) {
  const auto is_lidar = [](const SensorParams& s) { return s.isLidar(); };
  const auto& sensors = scenario.sensors;
  const auto lidar = std::find_if(sensors.begin(), sensors.end(), is_lidar);
  return std::count_if(sensors.begin(), sensors.end(), is_lidar) == 1 &&
         std::abs(lidar->rate - scenario.params.rate) < 1e-9;
}

std::string labelFileName(std::int64_t frame) { return fmt::format("{:06d}.label", frame); }

std::string labelBytes(const std::vector<std::uint32_t>& labels) {
  std::string bytes(4 * labels.size(), '\0');
  if (!labels.empty()) std::memcpy(bytes.data(), labels.data(), bytes.size());
  return bytes;
}

void removeLabels(const std::string& rawlog) {
  std::error_code error;
  for (const auto& file : std::filesystem::directory_iterator(labelFolderOf(rawlog), error)) {
    if (file.path().extension() == ".label") std::filesystem::remove(file.path(), error);
  }
}

}  // namespace perception
