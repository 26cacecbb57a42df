#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// How another sensor, or one behind other things, would have seen a scan.
enum class ScanVariant : std::uint8_t {
  kRecorded,      ///< as it is
  kHalfBeams,     ///< every second beam
  kQuarterBeams,  ///< every fourth beam
  kHalfColumns,   ///< every second step of azimuth
  kPlain,         ///< no intensities, ranges noisy by 3 cm
  kHidden,        ///< posts and low walls at random places in front
};
inline constexpr std::array<const char*, 6> kScanVariantNames = {
    "recorded",         "half the beams",        "a quarter of the beams",
    "half the columns", "no intensities, noisy", "posts in front"};
inline constexpr std::size_t kScanVariants = kScanVariantNames.size();

/// A changed scan and where its returns come from.
struct VariedScan {
  SensorFrame frame;
  std::vector<std::uint32_t> source;  ///< index of each return in the recorded cloud
  std::vector<bool> moved;            ///< those that lie on a post or wall now
};

/// `frame` holds a LidarCloud. What is drawn depends on `seed`, the stamp and the variant alone.
VariedScan variedScan(const SensorFrame& frame, ScanVariant variant, std::uint64_t seed);

/// Number of the beam of each return, 0 = lowest: the rings of the cloud, or else by elevation, of
/// which the returns of a beam share one to a tenth of a degree.
std::vector<std::uint16_t> beamNumbers(const LidarCloud& cloud);

}  // namespace perception
