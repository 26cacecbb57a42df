#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace perception {

/// Decimal places of result files: rounding is far below sensor resolution.
inline constexpr int kMeterPlaces = 4;   ///< [m], [m/s]: 0.1 mm
inline constexpr int kRadianPlaces = 6;  ///< [rad], [rad/s]: 0.05 mm at 50 m
inline constexpr int kProbabilityPlaces = 6;

/// The value with this many decimal places, independent of the locale; no negative zero.
std::string fixedPlaces(double value, int places);

/// Nanoseconds as exact decimal seconds with nine places: -1500000000 is "-1.500000000".
std::string decimalSeconds(std::int64_t nanoseconds);

/// The inverse, exact; false if `text` is not [-]digits[.digits] with at most nine decimal places,
/// or out of range.
bool parseDecimalSeconds(std::string_view text, std::int64_t& nanoseconds);

}  // namespace perception
