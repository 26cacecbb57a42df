#include "libperception/importers/clouds/CsvText.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "libperception/core/Error.h"
#include "libperception/importers/clouds/CloudTable.h"

namespace perception {
namespace {

constexpr const char *kComma = ", \t\r", *kSemicolon = "; \t\r", *kTabs = "\t\r";

/// Whether commas of the first lines lie between digits of fields that are separated by tabs alone.
bool hasCommasBehindTabs(std::string_view line) {
  if (line.find('\t') == std::string_view::npos || line.find(' ') != std::string_view::npos)
    return false;
  const std::size_t comma = line.find(',');
  return comma != std::string_view::npos && comma > 0 && comma + 1 < line.size() &&
         line[comma - 1] != '\t' && line[comma + 1] != '\t';
}

const char* separatorsOf(std::string_view line) {
  if (line.find(';') != std::string_view::npos) return kSemicolon;
  return hasCommasBehindTabs(line) ? kTabs : kComma;
}

bool isText(const TextRow& row) { return !row.isNumber(0) && row.text(0) != "nan"; }

}  // namespace

std::string_view withoutMark(std::string_view text) {
  constexpr std::string_view kMark = "\xef\xbb\xbf";
  if (text.substr(0, kMark.size()) == kMark) text.remove_prefix(kMark.size());
  return text;
}

CsvText csvTextOf(const std::string& path, std::string_view bytes) {
  const std::string_view start = bytes.substr(0, 2);
  if (start == "\xff\xfe" || start == "\xfe\xff")
    throw DataError(fmt::format("{}: text of two bytes a character, expected UTF-8", path));
  CsvText csv;
  csv.text = withoutMark(bytes);
  csv.text.erase(std::remove(csv.text.begin(), csv.text.end(), '"'), csv.text.end());
  csv.separators = kComma;
  // The second line decides, where there is one: names may hold any character.
  std::vector<std::string_view> first;
  TextLines start_lines(path, csv.text);
  while (first.size() < 2) {
    const auto line = start_lines.next();
    if (!line) break;
    if (line->find_first_not_of(" \t\r") != std::string_view::npos) first.push_back(*line);
  }
  if (!first.empty()) csv.separators = separatorsOf(first.back());
  if (csv.separators != kComma) std::replace(csv.text.begin(), csv.text.end(), ',', '.');
  TextLines lines(path, csv.text);
  for (std::size_t number = 1;; ++number) {
    const auto line = lines.next();
    if (!line) break;
    const TextRow row = lines.row(*line, csv.separators);
    if (row.size() == 0) continue;
    if (csv.first_line != 0) {
      ++csv.rows;
      continue;
    }
    csv.first_line = number, csv.columns = row.size();
    if (!isText(row)) ++csv.rows;
    for (std::size_t i = 0; isText(row) && i < row.size(); ++i) csv.names.push_back(row.text(i));
  }
  return csv;
}

}  // namespace perception
