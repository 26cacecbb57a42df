#include "libperception/importers/clouds/CloudTable.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>

#include "libperception/core/Error.h"
#include "libperception/core/LowerCase.h"

namespace perception {
namespace {

constexpr std::size_t kMostPoints = 1U << 24;  // more than any scanner has

template <class Number>
double as(const char* bytes) {
  Number value;
  std::memcpy(&value, bytes, sizeof(value));
  return static_cast<double>(value);
}

/// The ways in which programs write NaN and infinity.
bool isNoNumber(const std::string& text) {
  const std::string word = lowerCase(text.substr(text.find_first_not_of("+-") == 1 ? 1 : 0));
  return word == "nan" || word == "inf" || word == "infinity";
}

}  // namespace

bool isCloudColumn(const std::string& name, std::string_view what) {
  struct Names {
    std::string_view what;
    std::vector<std::string> names;
  };
  // VeloView's tables have vectors as three columns; CloudCompare's have scalars.
  static const std::vector<Names> kNames = {
      {"x", {"x", "points:0", "points_m_xyz:0"}},
      {"y", {"y", "points:1", "points_m_xyz:1"}},
      {"z", {"z", "points:2", "points_m_xyz:2"}},
      {"intensity",
       {"intensity", "i", "intensities", "reflectivity", "reflectance", "remission", "remissions",
        "scalar_intensity"}},
      {"ring", {"ring", "channel", "laser_id", "line", "ring_id"}},
      {"time", {"time", "t", "time_offset", "timestamp", "timestamps"}}};
  const std::string lower = lowerCase(name);
  for (const Names& row : kNames)
    if (row.what == what)
      return std::find(row.names.begin(), row.names.end(), lower) != row.names.end();
  return false;
}

double CloudColumn::numberAt(const char* bytes) const {
  switch (kind == 'F' ? size + 100 : kind == 'I' ? size + 200 : size) {
    case 104:
      return as<float>(bytes);
    case 108:
      return as<double>(bytes);
    case 201:
      return as<std::int8_t>(bytes);
    case 202:
      return as<std::int16_t>(bytes);
    case 204:
      return as<std::int32_t>(bytes);
    case 208:
      return as<std::int64_t>(bytes);
    case 1:
      return as<std::uint8_t>(bytes);
    case 2:
      return as<std::uint16_t>(bytes);
    case 4:
      return as<std::uint32_t>(bytes);
    default:
      return as<std::uint64_t>(bytes);
  }
}

bool CloudColumn::isKnown() const {
  const bool whole = size == 1 || size == 2 || size == 4 || size == 8;
  return count >= 1 && count <= 4096 && (kind == 'F' ? size == 4 || size == 8 : whole);
}

std::size_t CloudTable::rowBytes() const {
  std::size_t sum = 0;
  for (const CloudColumn& c : columns) sum += c.bytes();
  return sum;
}

std::optional<std::string_view> TextLines::next() {
  if (at_ >= text_.size()) return {};
  const std::size_t end = std::min(text_.find('\n', at_), text_.size());
  std::string_view line = text_.substr(at_, end - at_);
  at_ = end + 1;
  ++number_;
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

void TextLines::fail(const std::string& message) const {
  throw DataError(fmt::format("{}:{}: {}", path_, number_, message));
}

void readRows(std::string_view data, bool swapped, CloudTable& table) {
  std::size_t at = 0;
  char turned[8];
  for (std::size_t row = 0; row < table.rows; ++row) {
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      const CloudColumn& column = table.columns[c];
      const char* bytes = data.data() + at;
      if (swapped) {
        std::reverse_copy(bytes, bytes + column.size, turned);
        bytes = turned;
      }
      table.values[c][row] = column.numberAt(bytes);
      at += column.bytes();
    }
  }
}

void readColumns(std::string_view data, bool swapped, CloudTable& table) {
  std::size_t at = 0;
  char turned[8];
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const CloudColumn& column = table.columns[c];
    for (std::size_t row = 0; row < table.rows; ++row) {
      const char* bytes = data.data() + at + row * column.bytes();
      if (swapped) {
        std::reverse_copy(bytes, bytes + column.size, turned);
        bytes = turned;
      }
      table.values[c][row] = column.numberAt(bytes);
    }
    at += table.rows * column.bytes();
  }
}

void readTextRows(TextLines& lines, const char* separators, CloudTable& table) {
  for (std::size_t row = 0; row < table.rows;) {
    const auto line = lines.next();
    if (!line) lines.fail(fmt::format("ends after {} of {} points", row, table.rows));
    const TextRow fields = lines.row(*line, separators);
    if (fields.size() == 0) continue;
    std::size_t at = 0;
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      const std::string text = at < fields.size() ? fields.text(at) : "";
      table.values[c][row] =
          isNoNumber(text) ? std::numeric_limits<double>::quiet_NaN() : fields.real(at);
      at += table.columns[c].count;
    }
    ++row;
  }
}

void checkCount(const std::string& path, std::size_t points) {
  if (points > kMostPoints)
    throw DataError(fmt::format("{}: {} points, expected at most {}", path, points, kMostPoints));
}

void checkSize(const std::string& path, std::size_t got, std::size_t expected) {
  if (got < expected)
    throw DataError(
        fmt::format("{}: {} bytes of points, expected {}: the file was cut", path, got, expected));
}

void checkPromise(const std::string& path, std::size_t points, std::size_t bytes, double least) {
  constexpr std::size_t kFew = 1000;  // their memory is no matter, and their fault has its line
  if (points > kFew && static_cast<double>(points) * least > static_cast<double>(bytes + 1))
    throw DataError(
        fmt::format("{}: {} points in {} bytes: the file was cut", path, points, bytes));
}

}  // namespace perception
