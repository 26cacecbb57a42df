#pragma once
#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libperception/importers/ImportText.h"

namespace perception {

/// One column of numbers as a file stores it.
struct CloudColumn {
  std::string name;
  char kind = 'F';       ///< F float, I signed, U unsigned
  std::size_t size = 4;  ///< [bytes] of a number
  std::size_t count = 1;
  std::size_t bytes() const { return size * count; }
  /// Whether this kind and size is supported.
  bool isKnown() const;
  /// Decodes one little-endian number.
  double numberAt(const char* bytes) const;
};

/// Numeric columns of a point cloud file of any format.
struct CloudTable {
  std::vector<CloudColumn> columns;
  std::size_t rows = 0;
  std::string place;                        ///< of the first row: ":3" of text
  std::vector<std::vector<double>> values;  ///< [column][row]; the first element of vector columns

  void resize(std::size_t n) {
    rows = n;
    values.assign(columns.size(), std::vector<double>(n));
  }
  std::size_t rowBytes() const;
};

/// Lines of a text, with their numbers.
class TextLines {
 public:
  TextLines(const std::string& path, std::string_view text) : path_(path), text_(text) {}
  /// The next line without its newline; empty at the end of the text.
  std::optional<std::string_view> next();
  std::string_view rest() const { return text_.substr(std::min(at_, text_.size())); }
  /// Throws DataError with file and line.
  [[noreturn]] void fail(const std::string& message) const;
  TextRow row(std::string_view line, const char* separators = kSpaces) const {
    return TextRow(path_, number_, line, separators);
  }

 private:
  const std::string& path_;
  std::string_view text_;
  std::size_t at_ = 0, number_ = 0;
};

/// Row after row of binary numbers, each with all its columns; `swapped`: big-endian.
void readRows(std::string_view data, bool swapped, CloudTable& table);
/// Column after column.
void readColumns(std::string_view data, bool swapped, CloudTable& table);
/// Rows of text with the table's columns; "nan" is a number, and "inf" becomes it.
void readTextRows(TextLines& lines, const char* separators, CloudTable& table);

/// Throws DataError if there are more points than a scanner can have.
void checkCount(const std::string& path, std::size_t points);
/// Throws DataError if there are fewer bytes than expected.
void checkSize(const std::string& path, std::size_t got, std::size_t expected);
/// Before memory for many points is taken: throws DataError if `bytes` of them are too few at
/// `least` [bytes] a point.
void checkPromise(const std::string& path, std::size_t points, std::size_t bytes, double least);

/// PCD of PCL 0.7 (ascii, binary, binary_compressed) and PLY (ascii, binary of both byte orders).
CloudTable readPcd(const std::string& path, const std::string& bytes);
CloudTable readPly(const std::string& path, const std::string& bytes);
/// The line VIEWPOINT of a PCD header; empty if there is none or it is no pose.
std::optional<Pose3> pcdViewpoint(const std::string& path, const std::string& bytes);
/// Text in rows (CsvText) and an array of numpy: with names, or with columns that are named "-".
/// Units of meters and seconds that are behind the names are applied.
CloudTable readCsv(const std::string& path, const std::string& bytes);
CloudTable readNpy(const std::string& path, const std::string& bytes);
/// The one array of an archive of numpy that is a cloud, with those beside it that have one number
/// a point; or arrays x, y, z, ... of one number a point.
CloudTable readNpz(const std::string& path);

/// Whether programs give this name to a column: x, y, z, intensity, ring or time.
bool isCloudColumn(const std::string& name, std::string_view what);

}  // namespace perception
