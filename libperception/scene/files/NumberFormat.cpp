#include "libperception/scene/files/NumberFormat.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace perception {

std::string fixedPlaces(double value, int places) {
  std::string text = fmt::format("{:.{}f}", value, places);
  const bool zero = text.find_first_not_of("-0.") == std::string::npos;
  if (zero && text.front() == '-') text.erase(0, 1);
  return text;
}

std::string decimalSeconds(std::int64_t nanoseconds) {
  // Unsigned, since -INT64_MIN overflows.
  const auto bits = static_cast<std::uint64_t>(nanoseconds);
  const std::uint64_t magnitude = nanoseconds < 0 ? ~bits + 1 : bits;
  return fmt::format("{}{}.{:09}", nanoseconds < 0 ? "-" : "", magnitude / 1000000000u,
                     magnitude % 1000000000u);
}

bool parseDecimalSeconds(std::string_view text, std::int64_t& nanoseconds) {
  const bool negative = !text.empty() && text.front() == '-';
  const std::size_t first = negative ? 1 : 0;
  const std::size_t dot = std::min(text.find('.'), text.size());
  const std::size_t places = dot == text.size() ? 0 : text.size() - dot - 1;
  if (dot == first || places > 9 || (dot + 1 == text.size())) return false;
  std::string digits(text.substr(first, dot - first));
  digits += text.substr(text.size() - places);
  digits.append(9 - places, '0');
  std::uint64_t magnitude = 0;
  const auto [end, error] =
      std::from_chars(digits.data(), digits.data() + digits.size(), magnitude);
  if (error != std::errc() || end != digits.data() + digits.size()) return false;
  constexpr auto kLimit = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  if (magnitude > kLimit) return false;
  nanoseconds = static_cast<std::int64_t>(magnitude);
  if (negative) nanoseconds = -nanoseconds;
  return true;
}

}  // namespace perception
