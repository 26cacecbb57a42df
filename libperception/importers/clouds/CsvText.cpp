#include "libperception/importers/clouds/CsvText.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <iterator>
#include <optional>

#include "libperception/core/Error.h"
#include "libperception/importers/clouds/CloudTable.h"

namespace perception {
namespace {

using CsvFields = std::vector<std::string>;

constexpr std::string_view kBlanks = " \t\r";
constexpr std::size_t kLeastNumberFields = 3;  // of a row: x, y, z
constexpr std::size_t kMostLinesAbove = 100;   // in which the first row is looked for

std::string_view withoutBlanks(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

/// The line behind a comment's mark; empty: it is no comment.
std::optional<std::string_view> commentIn(std::string_view line) {
  const std::string_view text = withoutBlanks(line);
  for (const std::string_view mark : {"#", "//", "%"})
    if (text.substr(0, mark.size()) == mark) return text.substr(mark.size());
  return {};
}

/// The fields between separators that are not in quotation marks. Several spaces are one, and so
/// are those beside another separator.
CsvFields csvFieldsIn(std::string_view line, char separator) {
  CsvFields fields;
  std::string field;
  bool quoted = false;
  const auto end = [&](bool last) {
    const std::string_view text = withoutBlanks(field);
    if (separator != ' ' ? !last || !text.empty() || !fields.empty() : !text.empty())
      fields.emplace_back(text);
    field.clear();
  };
  for (const char c : line) {
    const bool separates = c == separator || (separator == ' ' && c == '\t');
    if (c == '"') {
      quoted = !quoted;
    } else if (separates && !quoted) {
      end(false);
    } else {
      field += c;
    }
  }
  end(true);
  return fields;
}

std::size_t countOutsideOfQuotes(std::string_view line, char wanted) {
  bool quoted = false;
  std::size_t count = 0;
  for (const char c : line) quoted = quoted != (c == '"'), count += !quoted && c == wanted;
  return count;
}

/// Whether every field can be a number with at most one decimal comma, and one has it.
bool haveDecimalCommas(const CsvFields& fields) {
  bool any = false;
  for (const std::string& field : fields) {
    const std::size_t comma = field.find(',');
    if (comma == std::string::npos) continue;
    const bool inside = comma > 0 && comma + 1 < field.size();
    if (!inside || field.find(',', comma + 1) != std::string::npos) return false;
    if (field.find('.') != std::string::npos) return false;
    any = true;
  }
  return any;
}

char separatorOf(std::string_view line) {
  if (countOutsideOfQuotes(line, ';') > 0) return ';';
  const bool commas = countOutsideOfQuotes(line, ',') > 0;
  if (countOutsideOfQuotes(line, '\t') > 0) {
    const CsvFields fields = csvFieldsIn(line, '\t');
    const bool spaced = std::any_of(fields.begin(), fields.end(), [](const std::string& f) {
      return f.find(' ') != std::string::npos;
    });
    if (!spaced && (!commas || haveDecimalCommas(fields))) return '\t';
  }
  if (!commas) return ' ';
  const CsvFields fields = csvFieldsIn(line, ' ');
  return fields.size() >= kLeastNumberFields && haveDecimalCommas(fields) ? ' ' : ',';
}

/// With the decimal point.
std::string pointed(std::string field) {
  std::replace(field.begin(), field.end(), ',', '.');
  return field;
}

bool isNumeric(std::string_view field) {
  if (!field.empty() && field.front() == '+') field.remove_prefix(1);
  double value = 0;
  const char* const end = field.data() + field.size();
  const auto result = std::from_chars(field.data(), end, value);
  return result.ec == std::errc() && result.ptr == end && !field.empty();
}

/// Most of its fields are numbers.
bool isRow(const CsvFields& fields) {
  const auto numbers = static_cast<std::size_t>(std::count_if(
      fields.begin(), fields.end(), [](const auto& f) { return isNumeric(pointed(f)); }));
  return numbers >= kLeastNumberFields && 2 * numbers > fields.size();
}

void dropEmptyEnd(CsvFields& fields, std::size_t wanted) {
  while (fields.size() > wanted && fields.back().empty()) fields.pop_back();
}

/// "x [m] , y" as "x[m] , y": units belong to their names.
std::string withUnitsAtNames(std::string_view line) {
  std::string out;
  bool inside = false;
  for (const char c : line) {
    inside = (inside || c == '[' || c == '(') && c != ']' && c != ')';
    const bool opens = c == '[' || c == '(';
    while (opens && !out.empty() && out.back() == ' ') out.pop_back();
    if (!inside || kBlanks.find(c) == std::string_view::npos) out += c;
  }
  return out;
}

/// Where the table begins, and its names.
class CsvBeginning {
 public:
  CsvBeginning(const std::string& path, const std::string& text, CsvText& csv) : csv_(csv) {
    TextLines lines(path, text);
    std::size_t number = 0;
    for (auto line = lines.next(); line && above_.size() < kMostLinesAbove; line = lines.next()) {
      ++number;
      if (withoutBlanks(*line).empty()) continue;
      const bool comment = commentIn(*line).has_value();
      if (!comment && begins(*line)) {
        csv_.first_line = number;
        break;
      }
      above_.push_back(*line), numbers_.push_back(number);
    }
    if (csv_.first_line == 0) takeWithoutNumbers();
    findNames();
  }
  char separator() const { return separator_; }

 private:
  bool begins(std::string_view line) {
    const char separator = separatorOf(line);
    CsvFields fields = csvFieldsIn(line, separator);
    if (!isRow(fields)) return false;
    separator_ = separator;
    dropEmptyEnd(fields, 1);
    csv_.columns = fields.size();
    return true;
  }
  /// No line of numbers: the first line that is no comment has names, if another follows.
  void takeWithoutNumbers() {
    for (std::size_t i = 0, plain = 0; i < above_.size(); ++i) {
      if (commentIn(above_[i]) || ++plain > 2) continue;
      CsvFields fields = csvFieldsIn(above_[i], separatorOf(above_[i]));
      dropEmptyEnd(fields, 1);
      const bool numbers = !fields.empty() && isNumeric(pointed(fields.front()));
      if (fields.empty() || (plain == 1 && !numbers)) continue;
      separator_ = separatorOf(above_[i]);
      csv_.first_line = numbers_[i], csv_.columns = fields.size();
      above_.resize(i);
      return;
    }
  }
  CsvFields namesIn(std::string_view line, char separator) const {
    const auto comment = commentIn(line);
    CsvFields names = csvFieldsIn(withUnitsAtNames(comment ? *comment : line), separator);
    dropEmptyEnd(names, 1);
    const bool text = !names.empty() && !names.front().empty() && !isNumeric(pointed(names[0])) &&
                      names[0] != "nan";
    return text ? names : CsvFields();
  }
  void findNames() {
    const char own = separator_ == 0 && !above_.empty() ? separatorOf(above_.back()) : separator_;
    for (auto line = above_.rbegin(); line != above_.rend(); ++line) {
      for (const char separator : {own, ',', ';', '\t', ' '}) {
        const CsvFields names = namesIn(*line, separator);
        if (!names.empty() && (names.size() == csv_.columns || csv_.first_line == 0))
          return setNames(names);
      }
    }
    // Names whose number differs: the rows will say so.
    for (auto line = above_.rbegin(); line != above_.rend(); ++line) {
      const CsvFields names = namesIn(*line, own);
      if (!commentIn(*line) && names.size() >= kLeastNumberFields) return setNames(names);
    }
  }
  void setNames(const CsvFields& names) {
    for (const std::string& name : names) {
      const std::size_t open = name.find_first_of("[(");
      const std::size_t close = name.find_first_of("])", std::min(open, name.size()));
      csv_.names.emplace_back(withoutBlanks(name.substr(0, open)));
      csv_.units.push_back(close == std::string::npos ? ""
                                                      : std::string(withoutBlanks(name.substr(
                                                            open + 1, close - open - 1))));
    }
  }

  CsvText& csv_;
  std::vector<std::string_view> above_;
  std::vector<std::size_t> numbers_;
  char separator_ = 0;
};

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
  const std::string text(withoutMark(bytes));
  const CsvBeginning beginning(path, text, csv);
  const std::size_t columns = csv.names.empty() ? csv.columns : csv.names.size();
  TextLines lines(path, text);
  csv.text.reserve(text.size());
  std::size_t number = 0;
  for (auto line = lines.next(); line; line = lines.next()) {
    const bool row = ++number >= csv.first_line && csv.first_line > 0 &&
                     !withoutBlanks(*line).empty() && !commentIn(*line);
    if (row) {
      CsvFields fields = csvFieldsIn(*line, beginning.separator());
      dropEmptyEnd(fields, columns);
      for (std::string& field : fields) field = field.empty() ? "nan" : pointed(field);
      fmt::format_to(std::back_inserter(csv.text), "{}", fmt::join(fields, kCsvFields));
      ++csv.rows;
    }
    csv.text += '\n';
  }
  return csv;
}

}  // namespace perception
