#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace perception {

/// The decimal places of every result file: well below what any sensor resolves, so that rounding
/// never matters.
inline constexpr int kMeterPlaces = 4;   ///< [m], [m/s]: 0.1 mm
inline constexpr int kRadianPlaces = 6;  ///< [rad], [rad/s]: 0.05 mm at 50 m
inline constexpr int kProbabilityPlaces = 6;

/// The value with that many decimal places, whatever the locale; zero never has a sign.
std::string fixedPlaces(double value, int places);

/// Nanoseconds as exact decimal seconds with nine places: -1500000000 is "-1.500000000".
std::string decimalSeconds(std::int64_t nanoseconds);

/// The inverse, exact; false when `text` is not [-]digits[.digits] with at most nine places or does
/// not fit.
bool parseDecimalSeconds(std::string_view text, std::int64_t& nanoseconds);

}  // namespace perception
