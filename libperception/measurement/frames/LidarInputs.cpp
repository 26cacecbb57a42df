#include "libperception/measurement/frames/LidarInputs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace perception {
namespace {

constexpr std::size_t kHandful = 8;  // values of an intensity that rank nothing (assumed)
constexpr std::size_t kPairs = 512;  // of returns in a row, that tell the order
constexpr float kNextTo = 0.05f;     // [rad] of azimuth between returns in a row (assumed)

bool isOrdered(const LidarCloud& cloud) {
  const std::size_t step = std::max<std::size_t>(1, cloud.size() / kPairs);
  std::size_t beside = 0, pairs = 0;
  for (std::size_t i = 0; i + 1 < cloud.size(); i += step, ++pairs) {
    const float cross = cloud.x[i] * cloud.y[i + 1] - cloud.y[i] * cloud.x[i + 1];
    const float dot = cloud.x[i] * cloud.x[i + 1] + cloud.y[i] * cloud.y[i + 1];
    beside += std::abs(std::atan2(cross, dot)) < kNextTo;
  }
  return 2 * beside > pairs;
}

const char* wordsOf(IntensityKind kind) {
  constexpr std::array<const char*, 4> kWords = {"", "no intensity",
                                                 "intensity is one value for all returns",
                                                 "intensity has only a handful of values"};
  return kWords[static_cast<std::size_t>(kind)];
}

}  // namespace

IntensityKind intensityKindOf(const LidarCloud& cloud) {
  if (cloud.size() == 0) return IntensityKind::kUsable;
  if (cloud.intensity.size() != cloud.size()) return IntensityKind::kNone;
  std::array<float, kHandful> seen{};
  std::size_t values = 0;
  for (const float v : cloud.intensity) {
    if (std::find(seen.begin(), seen.begin() + values, v) != seen.begin() + values) continue;
    if (values == kHandful) return IntensityKind::kUsable;
    seen[values++] = v;
  }
  return values == 1 ? IntensityKind::kFlat : IntensityKind::kSteps;
}

LidarInputs LidarInputs::of(const LidarCloud& cloud) {
  LidarInputs inputs;
  inputs.intensity = intensityKindOf(cloud);
  inputs.rings = !cloud.ring.empty(), inputs.times = !cloud.time_offset.empty();
  inputs.echoes = !cloud.echo.empty(), inputs.labels = !cloud.label.empty();
  inputs.ordered = isOrdered(cloud);
  if (inputs.rings) inputs.beams = 1 + *std::max_element(cloud.ring.begin(), cloud.ring.end());
  return inputs;
}

bool LidarInputs::operator==(const LidarInputs& o) const {
  return intensity == o.intensity && rings == o.rings && times == o.times && echoes == o.echoes &&
         labels == o.labels && ordered == o.ordered && beams == o.beams;
}

std::string LidarInputs::missing() const {
  std::vector<std::string> words;
  if (intensity != IntensityKind::kUsable) words.emplace_back(wordsOf(intensity));
  if (!rings) words.emplace_back("no numbers of beams");
  if (!times) words.emplace_back("no times of returns");
  if (!ordered) words.emplace_back("returns in no order");
  return fmt::format("{}", fmt::join(words, ", "));
}

}  // namespace perception
