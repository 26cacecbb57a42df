#include "libperception/pipeline/watches/InputWatch.h"

#include <fmt/format.h>

namespace perception {
namespace {

constexpr int kLook = 3;  // number of the scan that is described: the first may be cut (assumed)

const char* nameOf(IntensityKind kind) {
  constexpr const char* kNames[] = {"usable", "none", "flat", "steps"};
  return kNames[static_cast<int>(kind)];
}

}  // namespace

void InputWatch::apply(SensorFrame& frame) {
  auto* cloud = std::get_if<LidarCloud>(&frame.data);
  if (cloud == nullptr || cloud->size() == 0) return;
  int& looks = looks_[frame.sensor];
  if (looks < kLook && ++looks == kLook) {
    const LidarInputs inputs = LidarInputs::of(*cloud);
    const std::string missing = inputs.missing();
    if (!missing.empty())
      events_.add(frame.stamp, event_kind::kLidarInputs,
                  fmt::format("{}: {}", frame.sensor, missing),
                  {{"sensor", frame.sensor},
                   {"intensity", nameOf(inputs.intensity)},
                   {"rings", inputs.rings},
                   {"times", inputs.times},
                   {"echoes", inputs.echoes},
                   {"ordered", inputs.ordered},
                   {"beams", inputs.beams}});
  }
  if (intensityKindOf(*cloud) != IntensityKind::kUsable) cloud->intensity.clear();
}

}  // namespace perception
