#pragma once
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>

#include "libperception/core/Csv.h"
#include "libperception/core/system/PartialFile.h"

namespace perception {

/// May stand before the header of a table.
inline constexpr std::string_view kTableMark = "\xEF\xBB\xBF";

/// Opens a table for reading. Throws DataError (kNoInput when the file does not exist).
std::unique_ptr<std::FILE, FileCloser> openTable(const std::string& path);

/// The file of a CsvTable, read row by row: memory does not grow with the file.
class CsvStream {
 public:
  /// Reads the header. Throws DataError as CsvTable::fromFile(); faults of later lines are thrown
  /// when they are reached.
  explicit CsvStream(const std::string& path);

  /// Reads the next row; false after the last one.
  bool next();
  /// A table whose only row, number 0, is the one that was read last.
  const CsvTable& row() const { return table_; }

 private:
  struct Freer {
    void operator()(char* text) const { std::free(text); }
  };
  bool readLine();

  std::unique_ptr<std::FILE, FileCloser> file_;
  CsvTable table_;
  std::unique_ptr<char, Freer> buffer_;
  std::string_view line_;  // in buffer_
  std::size_t size_ = 0;   // of buffer_
  std::size_t number_ = 0;
};

}  // namespace perception
