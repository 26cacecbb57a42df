#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace perception {

/// A table of numbers as text, whatever program wrote it: fields are separated by commas, spaces,
/// semicolons or tabs, and may be in quotation marks; a comma that separates nothing is the decimal
/// point. A byte-order mark of UTF-8 is no part of the text. The first line of numbers tells where
/// the table begins: names are in a line above it with as many fields, which may be a comment
/// ("#", "//", "%"). What else is above it, and other comments, are no part of the table.
struct CsvText {
  /// Every line of the file: fields of rows separated by tabs, with decimal points; "nan" where a
  /// field is empty. Other lines are empty.
  std::string text;
  std::vector<std::string> names;  ///< without their units; empty: the file has none
  std::vector<std::string> units;  ///< of each name: "m" of "x [m]" or "x (m)"
  std::size_t first_line = 0;      ///< number of the first row; 0: none
  std::size_t columns = 0;         ///< fields of that line
  std::size_t rows = 0;            ///< lines of numbers
};

/// Separators of TextRow in CsvText::text.
inline constexpr const char* kCsvFields = "\t";

/// Throws DataError for text of two bytes a character (UTF-16).
CsvText csvTextOf(const std::string& path, std::string_view bytes);

/// The text without a byte-order mark of UTF-8.
std::string_view withoutMark(std::string_view text);

}  // namespace perception
