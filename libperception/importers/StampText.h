#pragma once
#include <cstdint>
#include <optional>
#include <string_view>

#include "libperception/core/Time.h"

namespace perception {

/// Seconds as text, "1574859771.744660272", exact to the nanosecond; whole numbers beyond 1e11 are
/// milliseconds, beyond 1e14 microseconds, beyond 1e17 nanoseconds. Empty if it is not such a
/// number.
std::optional<Stamp> stampOfSeconds(std::string_view text);
/// "2011-09-26 13:02:25.964389445", UTC, date and time separated by a space, T or _. Behind it
/// there may be a zone: Z, +02, +02:00 or +0200.
std::optional<Stamp> stampOfDate(std::string_view text);
/// Midnight of "2011-09-26".
std::optional<Stamp> stampOfDay(std::string_view text);

/// Resolution of MRPT's clock.
inline constexpr std::int64_t kTickNs = 100;
/// first + k / rate, rounded to kTickNs.
Stamp stampAtRate(Stamp first, std::int64_t k, double rate);

/// Start of recordings without a date: 2011-09-26 12:00:00 UTC, the day of most of KITTI's.
inline constexpr Stamp kUndatedStart{1317038400LL * 1'000'000'000};

}  // namespace perception
