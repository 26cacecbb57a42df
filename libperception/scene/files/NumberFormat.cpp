#include "libperception/scene/files/NumberFormat.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <limits>

namespace perception {

namespace {

/// `value` with `places` where its rounding to them is clear without exact arithmetic; else empty.
std::string clearlyFixed(double value, int places) {
  constexpr double kPower[] = {1, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6};
  constexpr double kMost = 1e10, kTie = 1e-4;  // a product below it is off by some 1e-6
  if (places < 0 || places >= static_cast<int>(std::size(kPower))) return {};
  const double scaled = std::abs(value) * kPower[places];
  if (!(scaled < kMost)) return {};  // NaN, too
  auto digits = static_cast<std::uint64_t>(scaled);
  const double rest = scaled - static_cast<double>(digits);
  if (std::abs(rest - 0.5) < kTie) return {};
  digits += rest > 0.5;
  const bool negative = value < 0 && digits > 0;
  char text[24];
  char* first = std::end(text);
  for (int k = 0; k <= places || digits > 0; ++k, digits /= 10) {
    if (k == places && k > 0) *--first = '.';
    *--first = static_cast<char>('0' + digits % 10);
  }
  if (negative) *--first = '-';
  return {first, std::end(text)};
}

}  // namespace

std::string fixedPlaces(double value, int places) {
  std::string text = clearlyFixed(value, places);
  if (!text.empty()) return text;
  text = fmt::format("{:.{}f}", value, places);
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
