#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace perception {

class CsvStream;

/// A strict table of comma-separated values: one header line, then one line per row, each with as
/// many fields as the header and terminated by a newline. Quoted fields are not supported (no file
/// of this project needs them); CR LF and a byte order mark are accepted; independent of the
/// locale. Every fault throws DataError as "file:line: column 'x': found 'abc', expected a number".
class CsvTable {
 public:
  using Column = std::size_t;

  /// Throws DataError (kNoInput when the file does not exist). A last line without newline is a
  /// fault: the file is truncated.
  static CsvTable fromFile(const std::string& path);
  static CsvTable fromText(std::string text, const std::string& name = "(text)");

  const std::string& name() const { return name_; }
  std::size_t rows() const { return lines_.size(); }
  const std::vector<std::string>& header() const { return header_; }
  bool has(std::string_view column) const;
  /// The index of the column; throws DataError when the header lacks it.
  Column column(std::string_view name) const;
  /// Line of the file, 1 = header, for messages.
  std::size_t lineOf(std::size_t row) const { return lines_[row]; }

  // Typed access to fields; throws DataError when a field does not parse as the type. A text() is
  // valid as long as the table.
  std::string_view text(std::size_t row, Column column) const;
  double real(std::size_t row, Column column) const;       ///< finite
  double realOrNan(std::size_t row, Column column) const;  ///< empty: NaN
  std::int64_t integer(std::size_t row, Column column) const;
  std::int64_t integerOr(std::size_t row, Column column, std::int64_t when_empty) const;
  std::uint64_t natural(std::size_t row, Column column) const;
  bool flag(std::size_t row, Column column) const;  ///< 0 or 1

  /// Throws DataError for that field.
  [[noreturn]] void fault(std::size_t row, Column column, std::string_view expected) const;

 private:
  friend class CsvStream;
  CsvTable() = default;
  void addRow(std::string_view line, std::size_t number);

  std::string name_;
  std::shared_ptr<const std::string> content_;  // referenced by fields_
  std::vector<std::string> header_;
  std::vector<std::string_view> fields_;  // row after row
  std::vector<std::size_t> lines_;        // line of the file of each row
};

}  // namespace perception
