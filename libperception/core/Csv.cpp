#include "libperception/core/Csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>

#include "libperception/core/CsvStream.h"
#include "libperception/core/Error.h"

namespace perception {
namespace {

std::string readWhole(const std::string& path) {
  const auto file = openTable(path);
  std::string content;
  char block[1 << 16];
  std::size_t count = 0;
  while ((count = std::fread(block, 1, sizeof block, file.get())) > 0) content.append(block, count);
  if (std::ferror(file.get())) {
    throw DataError(fmt::format("{}: cannot be read: {}", path, std::strerror(errno)));
  }
  return content;
}

/// Appends the fields of a line.
void split(std::string_view line, std::vector<std::string_view>& fields) {
  for (;;) {
    const std::size_t comma = line.find(',');
    fields.push_back(line.substr(0, comma));
    if (comma == std::string_view::npos) return;
    line.remove_prefix(comma + 1);
  }
}

// Parses the whole field as a number; from_chars is independent of the locale.
template <class Number>
bool parse(std::string_view field, Number& value) {
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  return error == std::errc() && end == field.data() + field.size();
}

}  // namespace

CsvTable CsvTable::fromFile(const std::string& path) { return fromText(readWhole(path), path); }

CsvTable CsvTable::fromText(std::string text, const std::string& name) {
  CsvTable table;
  table.name_ = name;
  table.content_ = std::make_shared<const std::string>(std::move(text));
  std::string_view rest = *table.content_;
  if (rest.substr(0, kTableMark.size()) == kTableMark) {
    rest.remove_prefix(kTableMark.size());
  }
  if (rest.empty()) {
    throw DataError(fmt::format("{}:1: empty, expected a header line of column names", name));
  }
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const std::size_t end = rest.find('\n');
    if (end == std::string_view::npos) {
      throw DataError(
          fmt::format("{}:{}: the file ends within this line, expected a line end "
                      "(was it cut?)",
                      name, number));
    }
    std::string_view line = rest.substr(0, end);
    rest.remove_prefix(end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    table.addRow(line, number);
  }
  return table;
}

void CsvTable::addRow(std::string_view line, std::size_t number) {
  if (number == 1) {
    std::vector<std::string_view> names;
    split(line, names);
    for (const std::string_view name : names) {
      if (name.empty() || has(name)) {
        throw DataError(fmt::format("{}:1: column name '{}' is {}", name_, name,
                                    name.empty() ? "empty" : "there twice"));
      }
      header_.emplace_back(name);
    }
    return;
  }
  const std::size_t before = fields_.size();
  split(line, fields_);
  if (fields_.size() - before != header_.size()) {
    throw DataError(fmt::format("{}:{}: found {} fields, expected {} as in the header", name_,
                                number, fields_.size() - before, header_.size()));
  }
  lines_.push_back(number);
}

bool CsvTable::has(std::string_view column) const {
  return std::find(header_.begin(), header_.end(), column) != header_.end();
}

CsvTable::Column CsvTable::column(std::string_view name) const {
  const auto found = std::find(header_.begin(), header_.end(), name);
  if (found == header_.end()) {
    throw DataError(
        fmt::format("{}:1: found no column '{}', expected it in the header", name_, name));
  }
  return static_cast<Column>(found - header_.begin());
}

std::string_view CsvTable::text(std::size_t row, Column column) const {
  return fields_[row * header_.size() + column];
}

double CsvTable::real(std::size_t row, Column column) const {
  double value = 0;
  if (!parse(text(row, column), value) || !std::isfinite(value)) fault(row, column, "a number");
  return value;
}

double CsvTable::realOrNan(std::size_t row, Column column) const {
  if (text(row, column).empty()) return std::numeric_limits<double>::quiet_NaN();
  double value = 0;
  if (!parse(text(row, column), value) || !std::isfinite(value)) {
    fault(row, column, "a number or nothing");
  }
  return value;
}

std::int64_t CsvTable::integer(std::size_t row, Column column) const {
  std::int64_t value = 0;
  if (!parse(text(row, column), value)) fault(row, column, "an integer");
  return value;
}

std::int64_t CsvTable::integerOr(std::size_t row, Column column, std::int64_t when_empty) const {
  return text(row, column).empty() ? when_empty : integer(row, column);
}

std::uint64_t CsvTable::natural(std::size_t row, Column column) const {
  std::uint64_t value = 0;
  if (!parse(text(row, column), value)) fault(row, column, "an integer of at least 0");
  return value;
}

bool CsvTable::flag(std::size_t row, Column column) const {
  const std::string_view field = text(row, column);
  if (field != "0" && field != "1") fault(row, column, "0 or 1");
  return field == "1";
}

void CsvTable::fault(std::size_t row, Column column, std::string_view expected) const {
  throw DataError(fmt::format("{}:{}: column '{}': found '{}', expected {}", name_, lines_[row],
                              header_[column], text(row, column), expected));
}

}  // namespace perception
