#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/core/LowerCase.h"
#include "libperception/importers/clouds/CloudTable.h"
#include "libperception/importers/clouds/CsvText.h"

namespace perception {
namespace {

/// [m] or [s] of a unit's name.
std::optional<double> sizeOfUnit(const std::string& given) {
  static constexpr std::pair<const char*, double> kUnits[] = {
      {"", 1},      {"m", 1},     {"meter", 1}, {"meters", 1}, {"cm", 1e-2},
      {"mm", 1e-3}, {"s", 1},     {"sec", 1},   {"ms", 1e-3},  {"us", 1e-6},
      {"µs", 1e-6}, {"ns", 1e-9}, {"km", 1e3},  {"ft", 0.3048}};
  const std::string unit = lowerCase(given);
  for (const auto& [name, size] : kUnits)
    if (unit == name) return size;
  return {};
}

/// Coordinates come in meters, and times in seconds, whatever unit the column's name has.
void takeUnit(const std::string& path, const std::string& unit, std::size_t column,
              CloudTable& table) {
  const std::string& name = table.columns[column].name;
  const bool coordinate =
      isCloudColumn(name, "x") || isCloudColumn(name, "y") || isCloudColumn(name, "z");
  if (unit.empty() || (!coordinate && !isCloudColumn(name, "time"))) return;
  const auto size = sizeOfUnit(unit);
  if (!size)
    throw DataError(
        fmt::format("{}: column {} is in '{}', expected m, cm, mm, km or ft for "
                    "coordinates, s, ms, us or ns for times",
                    path, name, unit));
  for (double& value : table.values[column]) value *= *size;
}

}  // namespace

CloudTable readCsv(const std::string& path, const std::string& bytes) {
  if (bytes.find('\n') == std::string::npos && bytes.find('\r') != std::string::npos) {
    std::string lines = bytes;  // ended as by old Macintosh programs
    std::replace(lines.begin(), lines.end(), '\r', '\n');
    return readCsv(path, lines);
  }
  const CsvText csv = csvTextOf(path, bytes);
  CloudTable table;
  for (const std::string& name : csv.names) table.columns.push_back({name});
  if (csv.names.empty()) table.columns.assign(csv.columns, {"-"});
  table.place = fmt::format(":{}", csv.first_line);
  checkCount(path, csv.rows);
  table.resize(csv.rows);
  TextLines lines(path, csv.text);
  if (table.rows > 0) readTextRows(lines, kCsvFields, table);
  for (std::size_t i = 0; i < csv.units.size(); ++i) takeUnit(path, csv.units[i], i, table);
  return table;
}

}  // namespace perception
