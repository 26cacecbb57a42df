#include "libperception/calibration/clusters/ScanVariants.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libperception/core/math/Angle.h"
#include "libperception/core/math/Random.h"

namespace perception {
namespace {

constexpr std::uint32_t kVariantPurpose = 0x7EE53;  // of random numbers

/// The returns at `source`, with all that is known of them.
LidarCloud pick(const LidarCloud& cloud, const std::vector<std::uint32_t>& source) {
  LidarCloud out;
  out.max_range = cloud.max_range;
  const auto take = [&](const auto& from, auto& to) {
    if (from.empty()) return;
    to.reserve(source.size());
    for (const std::uint32_t i : source) to.push_back(from[i]);
  };
  take(cloud.x, out.x), take(cloud.y, out.y), take(cloud.z, out.z);
  take(cloud.intensity, out.intensity), take(cloud.ring, out.ring);
  take(cloud.time_offset, out.time_offset), take(cloud.echo, out.echo);
  take(cloud.pulse_width, out.pulse_width), take(cloud.label, out.label);
  take(cloud.trust, out.trust);
  return out;
}

float azimuthOf(const LidarCloud& cloud, std::size_t i) {
  return std::atan2(cloud.y[i], cloud.x[i]);
}

/// Returns of every `step`-th beam.
std::vector<std::uint32_t> everyBeam(const LidarCloud& cloud, unsigned step) {
  const std::vector<std::uint16_t> beam = beamNumbers(cloud);
  std::vector<std::uint32_t> kept;
  for (std::uint32_t i = 0; i < cloud.size(); ++i)
    if (beam[i] % step == 0) kept.push_back(i);
  return kept;
}

/// Returns of every second of the columns that most scanners have, .2 degrees.
std::vector<std::uint32_t> everySecondColumn(const LidarCloud& cloud) {
  constexpr double kColumn = radians(0.2);
  std::vector<std::uint32_t> kept;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    const auto column =
        static_cast<int>(std::floor(static_cast<double>(azimuthOf(cloud, i)) / kColumn));
    if (column % 2 == 0) kept.push_back(i);
  }
  return kept;
}

void addNoise(LidarCloud& cloud, Rng& rng) {
  constexpr double kNoise = 0.03;  // [m] of good and of cheap scanners, by their data sheets
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const float range = std::hypot(cloud.x[i], cloud.y[i], cloud.z[i]);
    const float by = 1 + static_cast<float>(rng.normal(0, kNoise)) / std::max(range, 0.1F);
    cloud.x[i] *= by, cloud.y[i] *= by, cloud.z[i] *= by;
  }
}

/// A vertical post or a piece of a wall that faces the sensor, in the sensor's frame.
struct Screen {
  float azimuth, half;  ///< [rad] of its middle; half its width
  float range, top;     ///< [m]; z of its upper edge
};

std::vector<Screen> drawnScreens(double sensor_height, Rng& rng) {
  constexpr int kPosts = 16, kWalls = 8;
  std::vector<Screen> screens;
  for (int k = 0; k < kPosts + kWalls; ++k) {
    const bool post = k < kPosts;
    const double range = rng.uniform(3, 20);
    const double width = post ? rng.uniform(0.1, 0.5) : rng.uniform(1, 5);
    const double height = post ? rng.uniform(1.5, 5) : rng.uniform(0.5, 1.6);
    screens.push_back({static_cast<float>(rng.uniform(-kPi, kPi)),
                       static_cast<float>(width / 2 / range), static_cast<float>(range),
                       static_cast<float>(height - sensor_height)});
  }
  return screens;
}

/// Moves what lies behind a screen onto it, along its ray.
std::vector<bool> hide(LidarCloud& cloud, const std::vector<Screen>& screens) {
  constexpr float kBehind = 0.5F;  // [m]
  std::vector<bool> moved(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const float azimuth = azimuthOf(cloud, i);
    for (const Screen& s : screens) {
      const double off = wrapAngle(static_cast<double>(azimuth) - static_cast<double>(s.azimuth));
      if (std::abs(off) > static_cast<double>(s.half)) continue;
      const float range = std::hypot(cloud.x[i], cloud.y[i]), by = s.range / range;
      if (range < s.range + kBehind || cloud.z[i] * by > s.top) continue;
      cloud.x[i] *= by, cloud.y[i] *= by, cloud.z[i] *= by;
      moved[i] = true;
    }
  }
  return moved;
}

}  // namespace

std::vector<std::uint16_t> beamNumbers(const LidarCloud& cloud) {
  if (!cloud.ring.empty()) return cloud.ring;
  constexpr double kBin = radians(0.02), kLowest = radians(-45);
  constexpr int kBins = 4500, kReach = 4;  // a beam's returns lie within +-.08 degrees
  std::vector<int> bin(cloud.size()), count(kBins);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double slope = static_cast<double>(cloud.z[i]) /
                         static_cast<double>(std::max(0.1F, std::hypot(cloud.x[i], cloud.y[i])));
    bin[i] = std::clamp(static_cast<int>((std::atan(slope) - kLowest) / kBin), 0, kBins - 1);
    ++count[static_cast<std::size_t>(bin[i])];
  }
  // A beam is where more returns lie than in any bin about; the next one begins in the middle.
  std::vector<int> middles;
  std::vector<double> smooth(kBins);
  for (int b = kReach; b < kBins - kReach; ++b)
    for (int k = -kReach; k <= kReach; ++k)
      smooth[static_cast<std::size_t>(b)] +=
          (kReach + 1 - std::abs(k)) * count[static_cast<std::size_t>(b + k)];
  for (int b = kReach; b < kBins - kReach; ++b) {
    const auto at = smooth.begin() + b;
    if (*at > 0 && *at >= *std::max_element(at - kReach, at) &&
        *at > *std::max_element(at + 1, at + kReach + 1))
      middles.push_back(b);
  }
  std::vector<std::uint16_t> beam(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto above = std::lower_bound(middles.begin(), middles.end(), bin[i]);
    auto number = above - middles.begin();
    if (above == middles.end() || (number > 0 && bin[i] - *(above - 1) < *above - bin[i])) --number;
    beam[i] = static_cast<std::uint16_t>(std::max<std::ptrdiff_t>(number, 0));
  }
  return beam;
}

VariedScan variedScan(const SensorFrame& frame, ScanVariant variant, std::uint64_t seed) {
  const auto& cloud = std::get<LidarCloud>(frame.data);
  Rng rng({seed, static_cast<std::uint64_t>(frame.stamp.ns), static_cast<std::uint32_t>(variant),
           kVariantPurpose});
  VariedScan out{frame, {}, {}};
  if (variant == ScanVariant::kHalfBeams || variant == ScanVariant::kQuarterBeams) {
    out.source = everyBeam(cloud, variant == ScanVariant::kHalfBeams ? 2 : 4);
  } else if (variant == ScanVariant::kHalfColumns) {
    out.source = everySecondColumn(cloud);
  } else {
    for (std::uint32_t i = 0; i < cloud.size(); ++i) out.source.push_back(i);
  }
  LidarCloud changed = pick(cloud, out.source);
  out.moved.assign(changed.size(), false);
  if (variant == ScanVariant::kPlain) {
    changed.intensity.clear();
    addNoise(changed, rng);
  } else if (variant == ScanVariant::kHidden) {
    out.moved = hide(changed, drawnScreens(frame.T_ego_sensor.translation().z(), rng));
  }
  out.frame.data = std::move(changed);
  return out;
}

}  // namespace perception
