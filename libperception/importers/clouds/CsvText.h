#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace perception {

/// A table of numbers as text, whatever program wrote it: fields are separated by commas and
/// spaces, or by semicolons or tabs; behind these a comma is the decimal point. A byte-order mark
/// of UTF-8 and quotation marks are no part of the text.
struct CsvText {
  std::string text;                ///< with decimal points, without the mark
  const char* separators = "";     ///< of TextRow
  std::vector<std::string> names;  ///< in its first line; empty: that holds numbers
  std::size_t first_line = 0;      ///< number of the first line that is not blank; 0: none
  std::size_t columns = 0;         ///< fields of that line
  std::size_t rows = 0;            ///< lines of numbers
};

/// Throws DataError for text of two bytes a character (UTF-16).
CsvText csvTextOf(const std::string& path, std::string_view bytes);

/// The text without a byte-order mark of UTF-8.
std::string_view withoutMark(std::string_view text);

}  // namespace perception
