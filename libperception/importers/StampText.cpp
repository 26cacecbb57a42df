#include "libperception/importers/StampText.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>

namespace perception {
namespace {

constexpr std::int64_t kMostSeconds = 9'000'000'000;          ///< since 1970, that is in 2255
constexpr std::int64_t kLeastMilliseconds = 100'000'000'000;  ///< since 1970, that is in 1973

bool wholeNumber(std::string_view text, std::int64_t& value) {
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  return result.ec == std::errc() && result.ptr == text.data() + text.size();
}

/// Days since 1970-01-01 in the proleptic Gregorian calendar (Howard Hinnant's algorithm).
std::int64_t daysSince1970(std::int64_t year, std::int64_t month, std::int64_t day) {
  const std::int64_t y = year - (month <= 2 ? 1 : 0), era = y / 400, of_era = y - 400 * era;
  const std::int64_t of_year = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
  return era * 146097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719468;
}

/// The digits of text[begin, begin + count) as a number in [least, most].
bool field(std::string_view text, std::size_t begin, std::size_t count, std::int64_t least,
           std::int64_t most, std::int64_t& value) {
  return begin + count <= text.size() && wholeNumber(text.substr(begin, count), value) &&
         value >= least && value <= most;
}

/// [min] east of Greenwich of "Z", "+02", "+02:00", "-0530".
std::optional<std::int64_t> zoneOf(std::string_view text) {
  if (text == "Z") return 0;
  std::int64_t hours = 0, minutes = 0;
  if (!field(text, 1, 2, 0, 14, hours)) return {};
  const std::size_t colon = text.size() > 3 && text[3] == ':' ? 1 : 0;
  if (text.size() > 3 && (text.size() != 5 + colon || !field(text, 3 + colon, 2, 0, 59, minutes)))
    return {};
  return (text[0] == '-' ? -1 : 1) * (60 * hours + minutes);
}

/// Of milliseconds, microseconds or nanoseconds since 1970, told apart by their number.
std::optional<Stamp> stampOfTicks(std::int64_t ticks) {
  std::int64_t a_second = 1000;  // ticks
  while (a_second < 1'000'000'000 && ticks / a_second >= kLeastMilliseconds) a_second *= 1000;
  if (ticks / a_second > kMostSeconds) return {};
  return Stamp{ticks * (1'000'000'000 / a_second)};
}

}  // namespace

std::optional<Stamp> stampOfSeconds(std::string_view text) {
  const std::size_t dot = std::min(text.find('.'), text.size());
  std::int64_t seconds = 0, fraction = 0;
  if (!wholeNumber(text.substr(0, dot), seconds) || seconds < 0) return {};
  if (dot == text.size() && seconds >= kLeastMilliseconds) return stampOfTicks(seconds);
  if (seconds > kMostSeconds) return {};
  std::string digits(dot < text.size() ? text.substr(dot + 1, 9) : std::string_view());
  digits.resize(9, '0');
  if (!std::all_of(digits.begin(), digits.end(), [](char c) { return c >= '0' && c <= '9'; }) ||
      !wholeNumber(digits, fraction))
    return {};
  return Stamp{seconds * 1'000'000'000 + fraction};
}

std::optional<Stamp> stampOfDay(std::string_view text) {
  std::int64_t year = 0, month = 0, day = 0;
  if (text.size() != 10 || text[4] != '-' || text[7] != '-') return {};
  if (!field(text, 0, 4, 1970, 2105, year) || !field(text, 5, 2, 1, 12, month) ||
      !field(text, 8, 2, 1, 31, day))
    return {};
  return Stamp{daysSince1970(year, month, day) * 86400 * 1'000'000'000};
}

std::optional<Stamp> stampOfDate(std::string_view text) {
  if (const std::size_t at = text.find_first_of("Z+-", 19); at != std::string_view::npos) {
    const auto zone = zoneOf(text.substr(at));
    const auto there = stampOfDate(text.substr(0, at));
    if (!zone || !there) return {};
    return Stamp{there->ns - *zone * 60 * 1'000'000'000};
  }
  if (text.size() < 19 || text[13] != ':' || text[16] != ':') return {};
  const auto day = stampOfDay(text.substr(0, 10));
  std::int64_t hour = 0, minute = 0;
  const auto seconds = stampOfSeconds(text.substr(17));
  if (!day || !seconds || !field(text, 11, 2, 0, 23, hour) || !field(text, 14, 2, 0, 59, minute))
    return {};
  return Stamp{day->ns + (hour * 60 + minute) * 60 * 1'000'000'000 + seconds->ns};
}

Stamp stampAtRate(Stamp first, std::int64_t k, double rate) {
  const double ticks = std::round(static_cast<double>(k) / rate * (1e9 / kTickNs));
  return {first.ns + static_cast<std::int64_t>(ticks) * kTickNs};
}

}  // namespace perception
