#include "libperception/weather/state/AirCensus.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Angle.h"
#include "libperception/simd/FastAtan2.h"

namespace perception {
namespace {

// Of all returns every seventh is counted, for seven: no number of beams is a multiple of it.
constexpr std::size_t kStep = 7;
constexpr float kInAir = 0.4F;  // [m] above the ground
// Sines of elevations.
const float kLevelFrom = std::sin(static_cast<float>(radians(-2))),
            kLevelTo = std::sin(static_cast<float>(radians(1))),
            kBelowFrom = std::sin(static_cast<float>(radians(-7.5))),
            kBelowTo = std::sin(static_cast<float>(radians(-4.5)));
// [m] a surface of 20 % beyond it sends back no more than the drops and flakes that are just seen.
constexpr float kOpen = 40;

bool isLevel(float up) { return up > kLevelFrom && up < kLevelTo; }

std::size_t sectorOf(float x, float y) {
  // Where a close angle (3e-4 rad) is clearly within a sector, the exact one is in it, too.
  constexpr float kClose = 1e-4F * static_cast<float>(AirCensus::kSectors);
  const float place = (fastAtan2(x, y) / static_cast<float>(kTwoPi) + 0.5F) *
                      static_cast<float>(AirCensus::kSectors);
  const auto near = static_cast<std::size_t>(place);
  const float within = place - static_cast<float>(near);
  if (within > kClose && within < 1 - kClose) return near;
  const float turn = std::atan2(y, x) / static_cast<float>(kTwoPi) + 0.5F;
  const auto sector = static_cast<std::size_t>(turn * static_cast<float>(AirCensus::kSectors));
  return std::min(sector, AirCensus::kSectors - 1);
}

void countReturn(float x, float y, float range, float height, float mount, AirCensus& census) {
  AirCensus::Sector& sector = census.sectors[sectorOf(x, y)];
  const float up = (height - mount) / range;
  sector.returns += kStep;
  if (isLevel(up)) {
    sector.level += kStep;
    if (range < kOpen) sector.blocked += kStep;
  }
  if (up > kBelowFrom && up < kBelowTo) sector.below += kStep;
  const auto bin = std::min(static_cast<std::size_t>(range / 2), AirCensus::kReachBins - 1);
  if (std::abs(height) < kInAir) {
    census.ground[bin] += kStep;
  } else if (height > 0) {
    census.upright[bin] += kStep;
  }
}

void countLevel(const LidarCloud& cloud, std::size_t i, float range, std::size_t shell,
                AirCensus::Sector& sector) {
  sector.level_lone[shell] += 1;
  if (shell > 0 || i >= cloud.intensity.size()) return;
  sector.brightness += static_cast<double>(cloud.intensity[i] * range);
  sector.lit += cloud.intensity[i] > 0 ? 1 : 0;
}

}  // namespace

AirCensus AirCensus::of(const SensorFrame& frame, const LidarCloud& cloud,
                        const SuspectReturns& suspects) {
  AirCensus census;
  census.max_range = cloud.max_range;
  const HeightAboveGround above(frame.T_ego_sensor, frame.ground);
  const float mount = above.of(0, 0, 0);
  for (std::size_t i = 0; i < cloud.size(); i += kStep) {
    const float x = cloud.x[i], y = cloud.y[i], z = cloud.z[i];
    const float range = std::sqrt(x * x + y * y + z * z);
    if (range > kShells.front()) countReturn(x, y, range, above.of(x, y, z), mount, census);
  }
  for (std::size_t s = 0; s < suspects.count; ++s) {
    const float range = suspects.range[s];
    if (range < kShells.front() || range >= kShells.back() || suspects.height[s] < kInAir) continue;
    if (NeighborCounts(suspects.neighbors[s]).around() > 0) continue;
    std::size_t shell = 0;
    while (range >= kShells[shell + 1]) ++shell;
    const std::size_t i = suspects.index[s];
    AirCensus::Sector& sector = census.sectors[sectorOf(cloud.x[i], cloud.y[i])];
    sector.lone[shell] += 1;
    if (isLevel((suspects.height[s] - mount) / range)) countLevel(cloud, i, range, shell, sector);
  }
  // In the mean: a scan's difference may be below 0, as one is counted and the other one sampled.
  for (Sector& sector : census.sectors)
    for (const double lone : sector.level_lone) sector.blocked -= lone;
  return census;
}

}  // namespace perception
