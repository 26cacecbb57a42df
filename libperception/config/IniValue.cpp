#include "libperception/config/IniValue.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <system_error>

#include "libperception/core/math/Angle.h"

namespace perception {
namespace {

constexpr std::string_view kWhiteSpace = " \t\r\v\f";

// std::from_chars is independent of the locale and accepts neither white space nor a hex prefix; a
// leading '+' is removed for it.
template <class Number>
std::optional<Number> parseWhole(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

// Optimal string alignment distance (Damerau-Levenshtein with neighbors swapped once), ignoring
// case.
std::size_t editDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t cost = lower(a[i - 1]) == lower(b[j - 1]) ? 0 : 1;
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + cost});
      if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) &&
          lower(a[i - 2]) == lower(b[j - 1])) {
        row[j] = std::min(row[j], before[j - 2] + 1);
      }
    }
    std::swap(before, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

bool isControl(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }

}  // namespace

std::optional<double> parseReal(std::string_view text) {
  const auto value = parseWhole<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<long long> parseInteger(std::string_view text) { return parseWhole<long long>(text); }

std::optional<unsigned long long> parseUnsigned(std::string_view text) {
  return parseWhole<unsigned long long>(text);
}

std::optional<bool> parseBoolean(std::string_view text) {
  if (text == "true" || text == "yes" || text == "on" || text == "1") return true;
  if (text == "false" || text == "no" || text == "off" || text == "0") return false;
  return std::nullopt;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kWhiteSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kWhiteSpace) - first + 1);
}

std::vector<std::string_view> splitList(std::string_view text) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t comma = text.find(',');
    parts.push_back(trimmed(text.substr(0, comma)));
    if (comma == std::string_view::npos) return parts;
    text.remove_prefix(comma + 1);
  }
}

std::string formatReal(double value) { return fmt::format("{}", value); }

std::optional<std::string> formatDegrees(double angle_rad) {
  if (!std::isfinite(angle_rad)) return std::nullopt;
  const double close = degrees(angle_rad);
  for (int digits = 1; digits <= 17; ++digits) {
    const auto rounded = parseReal(fmt::format("{:.{}g}", close, digits));
    if (rounded && radians(*rounded) == angle_rad) return formatReal(*rounded);
  }
  // Not every double is radians() of another: try the neighbors, then give up.
  double below = close, above = close;
  for (int i = 0; i < 4; ++i) {
    below = std::nextafter(below, -HUGE_VAL);
    above = std::nextafter(above, HUGE_VAL);
    if (radians(below) == angle_rad) return formatReal(below);
    if (radians(above) == angle_rad) return formatReal(above);
  }
  return std::nullopt;
}

std::size_t commentStart(std::string_view text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool marks = text[i] == ';' || text[i] == '#';
    if (marks && (i == 0 || kWhiteSpace.find(text[i - 1]) != std::string_view::npos)) return i;
  }
  return text.size();
}

bool survivesWriting(std::string_view text) {
  return !text.empty() && trimmed(text) == text && commentStart(text) == text.size() &&
         std::none_of(text.begin(), text.end(), [](char c) { return isControl(c) && c != '\t'; });
}

std::string rangeText(Bounds allowed) {
  const bool below = std::isfinite(allowed.low), above = std::isfinite(allowed.high);
  if (below && above) {
    return fmt::format("{} .. {}", formatReal(allowed.low), formatReal(allowed.high));
  }
  if (below) return fmt::format(">= {}", formatReal(allowed.low));
  return above ? fmt::format("<= {}", formatReal(allowed.high)) : "";
}

std::string escaped(std::string_view text) {
  std::string shown;
  for (const char c : text) {
    if (isControl(c)) {
      shown += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    } else {
      shown += c;
    }
  }
  return shown;
}

std::string inQuotes(std::string_view text) {
  constexpr std::size_t kLongest = 80;
  return "'" + escaped(text.substr(0, kLongest)) + (text.size() > kLongest ? "...'" : "'");
}

std::string nearestWord(const std::string& word, const std::vector<std::string>& candidates) {
  constexpr std::size_t kLongest = 100;  // a longer word is no misspelled key
  if (word.size() > kLongest) return "";
  std::size_t best = std::max<std::size_t>(1, word.size() / 3) + 1;
  std::string nearest;
  for (const auto& candidate : candidates) {
    if (candidate.size() > kLongest) continue;
    const std::size_t distance = editDistance(word, candidate);
    if (distance < best) {
      best = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

}  // namespace perception
