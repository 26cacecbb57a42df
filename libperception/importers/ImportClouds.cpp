#include "libperception/importers/ImportClouds.h"

#include <fmt/format.h>
#include <liblzf/lzf.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string_view>

#include "libperception/core/Error.h"
#include "libperception/importers/ImportText.h"

namespace perception {
namespace {

constexpr std::size_t kMostPoints = 1U << 24;  // no scanner has them
constexpr std::size_t kMostBytes = std::size_t{1} << 30;

/// One column of numbers as a file stores it.
struct Column {
  std::string name;
  char kind = 'F';       ///< F float, I signed, U unsigned
  std::size_t size = 4;  ///< [bytes] of a number
  std::size_t count = 1;
  std::size_t bytes() const { return size * count; }
};

/// Columns of numbers, whatever the file was.
struct Table {
  std::vector<Column> columns;
  std::size_t rows = 0;
  std::vector<std::vector<double>> values;  ///< [column][row]; of columns of several the first

  void resize(std::size_t n) {
    rows = n;
    values.assign(columns.size(), std::vector<double>(n));
  }
};

double nan() { return std::numeric_limits<double>::quiet_NaN(); }

template <class Number>
double as(const char* bytes) {
  Number value;
  std::memcpy(&value, bytes, sizeof(value));
  return static_cast<double>(value);
}

/// A number of a column, little-endian.
double numberAt(const char* bytes, const Column& c) {
  switch (c.kind == 'F' ? c.size + 100 : c.kind == 'I' ? c.size + 200 : c.size) {
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

bool known(const Column& c) {
  const bool whole = c.size == 1 || c.size == 2 || c.size == 4 || c.size == 8;
  return c.count >= 1 && c.count <= 4096 && (c.kind == 'F' ? c.size == 4 || c.size == 8 : whole);
}

/// Row after row, each with all its columns.
void readRows(std::string_view data, bool swapped, Table& table) {
  std::size_t at = 0;
  char turned[8];
  for (std::size_t row = 0; row < table.rows; ++row) {
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      const Column& column = table.columns[c];
      const char* bytes = data.data() + at;
      if (swapped) {
        std::reverse_copy(bytes, bytes + column.size, turned);
        bytes = turned;
      }
      table.values[c][row] = numberAt(bytes, column);
      at += column.bytes();
    }
  }
}

std::size_t rowBytes(const Table& table) {
  std::size_t sum = 0;
  for (const Column& c : table.columns) sum += c.bytes();
  return sum;
}

/// Lines of a text, with their numbers.
class Lines {
 public:
  Lines(const std::string& path, std::string_view text) : path_(path), text_(text) {}
  /// The next line without its end; empty at the end of the text.
  std::optional<std::string_view> next() {
    if (at_ >= text_.size()) return {};
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    std::string_view line = text_.substr(at_, end - at_);
    at_ = end + 1;
    ++number_;
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
  }
  std::string_view rest() const { return text_.substr(std::min(at_, text_.size())); }
  [[noreturn]] void fail(const std::string& message) const {
    throw DataError(fmt::format("{}:{}: {}", path_, number_, message));
  }
  TextRow row(std::string_view line, const char* separators = kSpaces) const {
    return TextRow(path_, number_, line, separators);
  }

 private:
  const std::string& path_;
  std::string_view text_;
  std::size_t at_ = 0, number_ = 0;
};

/// Rows of text with the table's columns; "nan" is a number.
void readTextRows(Lines& lines, const char* separators, Table& table) {
  for (std::size_t row = 0; row < table.rows;) {
    const auto line = lines.next();
    if (!line) lines.fail(fmt::format("ends after {} of {} points", row, table.rows));
    const TextRow fields = lines.row(*line, separators);
    if (fields.size() == 0) continue;
    std::size_t at = 0;
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      const std::string text = at < fields.size() ? fields.text(at) : "";
      const bool is_nan = text == "nan" || text == "NaN" || text == "-nan";
      table.values[c][row] = is_nan ? nan() : fields.real(at);
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

/// PCL's compression: columns one after the other, as one LZF block after two sizes.
void readCompressed(const std::string& path, std::string_view data, Table& table) {
  checkSize(path, data.size(), 8);
  const auto packed = static_cast<std::size_t>(as<std::uint32_t>(data.data()));
  const auto unpacked = static_cast<std::size_t>(as<std::uint32_t>(data.data() + 4));
  checkSize(path, data.size() - 8, packed);
  if (unpacked != table.rows * rowBytes(table))
    throw DataError(fmt::format("{}: {} bytes of points after unpacking, expected {}", path,
                                unpacked, table.rows * rowBytes(table)));
  if (unpacked == 0) return;
  std::string bytes(unpacked, '\0');
  if (lzf_decompress(data.data() + 8, static_cast<unsigned>(packed), bytes.data(),
                     static_cast<unsigned>(unpacked)) != unpacked)
    throw DataError(path + ": damaged LZF data");
  std::size_t at = 0;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const Column& column = table.columns[c];
    for (std::size_t row = 0; row < table.rows; ++row)
      table.values[c][row] = numberAt(bytes.data() + at + row * column.bytes(), column);
    at += table.rows * column.bytes();
  }
}

/// One line of a PCD header: a word and its values, one a column.
void readPcdHeader(const TextRow& row, Table& table, std::size_t& points) {
  const std::string key = row.text(0);
  const auto values = row.size() - 1;
  if (key == "FIELDS" || key == "COLUMNS") {
    table.columns.resize(values);
    for (std::size_t i = 0; i < values; ++i) table.columns[i].name = row.text(i + 1);
  } else if (key == "SIZE" || key == "TYPE" || key == "COUNT") {
    row.expect(values == table.columns.size(),
               fmt::format("{} and one for each of {} FIELDS", key, table.columns.size()));
    for (std::size_t i = 0; i < values; ++i) {
      Column& c = table.columns[i];
      if (key == "TYPE") {
        c.kind = row.text(i + 1).front();
      } else {
        (key == "SIZE" ? c.size : c.count) = static_cast<std::size_t>(row.frame(i + 1));
      }
    }
  } else if (key == "POINTS") {
    points = static_cast<std::size_t>(row.frame(1));
  }
}

Table readPcd(const std::string& path, const std::string& bytes) {
  Lines lines(path, bytes);
  Table table;
  std::size_t points = 0;
  std::string data;
  while (data.empty()) {
    const auto line = lines.next();
    if (!line) lines.fail("no line DATA, expected a PCD file");
    const TextRow row = lines.row(*line);
    if (row.size() == 0 || row.text(0).front() == '#') continue;
    if (row.text(0) == "DATA") {
      data = row.text(1);
    } else {
      readPcdHeader(row, table, points);
    }
  }
  if (table.columns.empty()) lines.fail("no line FIELDS before DATA, expected a PCD file");
  for (const Column& c : table.columns) {
    if (!known(c))
      lines.fail(
          fmt::format("field {}: TYPE {} of SIZE {} is none of PCL's", c.name, c.kind, c.size));
  }
  checkCount(path, points);
  table.resize(points);
  if (data == "ascii") {
    readTextRows(lines, kSpaces, table);
  } else if (data == "binary") {
    checkSize(path, lines.rest().size(), points * rowBytes(table));
    readRows(lines.rest(), false, table);
  } else if (data == "binary_compressed") {
    readCompressed(path, lines.rest(), table);
  } else {
    lines.fail(fmt::format("DATA {}, expected ascii, binary or binary_compressed", data));
  }
  return table;
}

/// "float32", "uchar" ... as a column.
Column plyColumn(const TextRow& row) {
  struct Type {
    const char *name, *other;
    char kind;
    std::size_t size;
  };
  static constexpr Type kTypes[] = {{"float", "float32", 'F', 4}, {"double", "float64", 'F', 8},
                                    {"char", "int8", 'I', 1},     {"uchar", "uint8", 'U', 1},
                                    {"short", "int16", 'I', 2},   {"ushort", "uint16", 'U', 2},
                                    {"int", "int32", 'I', 4},     {"uint", "uint32", 'U', 4}};
  row.expect(row.size() == 3, "3 for a vertex: property TYPE NAME (no lists)");
  for (const Type& type : kTypes) {
    if (row.text(1) == type.name || row.text(1) == type.other)
      return {row.text(2), type.kind, type.size, 1};
  }
  row.fail(1, "a type of PLY");
}

Table readPly(const std::string& path, const std::string& bytes) {
  Lines lines(path, bytes);
  Table table;
  std::string format, element;
  std::optional<std::size_t> points;
  const auto first = lines.next();
  if (!first || *first != "ply") lines.fail("no line 'ply', expected a PLY file");
  while (const auto line = lines.next()) {
    const TextRow row = lines.row(*line);
    if (row.size() == 0) continue;
    const std::string key = row.text(0);
    if (key == "end_header") break;
    if (key == "format") format = row.text(1);
    if (key == "element") {
      element = row.text(1);
      if (element == "vertex") points = static_cast<std::size_t>(row.frame(2));
      if (!points) row.failLine("an element before vertex: expected the points first");
    }
    if (key == "property" && element == "vertex") table.columns.push_back(plyColumn(row));
  }
  if (!points || table.columns.empty()) lines.fail("no element vertex, expected points");
  checkCount(path, *points);
  table.resize(*points);
  if (format == "ascii") {
    readTextRows(lines, kSpaces, table);
  } else if (format == "binary_little_endian" || format == "binary_big_endian") {
    checkSize(path, lines.rest().size(), *points * rowBytes(table));
    readRows(lines.rest(), format == "binary_big_endian", table);
  } else {
    lines.fail(
        fmt::format("format '{}', expected ascii, binary_little_endian or "
                    "binary_big_endian",
                    format));
  }
  return table;
}

Table readBin(const std::string& path, const std::string& bytes, const CloudFormat& format) {
  Table table;
  for (const std::string& name : format.columns) table.columns.push_back({name});
  const std::size_t row = rowBytes(table);
  if (row == 0 || bytes.size() % row != 0) {
    throw DataError(fmt::format("{}: {} bytes, expected {} a point (float32 {})", path,
                                bytes.size(), row, fmt::join(format.columns, ", ")));
  }
  table.resize(bytes.size() / row);
  readRows(bytes, false, table);
  return table;
}

constexpr const char* kCsvSeparators = ",; \t\r";

Table readCsvCloud(const std::string& path, const std::string& bytes, const CloudFormat& format) {
  Table table;
  Lines counter(path, bytes);
  std::size_t rows = 0;
  bool has_names = false;
  while (const auto line = counter.next()) {
    const TextRow row = counter.row(*line, kCsvSeparators);
    if (row.size() == 0) continue;
    if (rows++ > 0) continue;
    has_names = !row.isNumber(0) && row.text(0) != "nan";
    if (!has_names) {
      row.expect(row.size() >= format.columns.size(),
                 fmt::format("{}: {}", format.columns.size(), fmt::join(format.columns, ", ")));
    }
    for (std::size_t i = 0; has_names && i < row.size(); ++i)
      table.columns.push_back({row.text(i)});
  }
  for (std::size_t i = 0; !has_names && i < format.columns.size(); ++i)
    table.columns.push_back({format.columns[i]});
  checkCount(path, rows);
  table.resize(rows - (has_names ? 1 : 0));
  Lines lines(path, bytes);
  while (has_names) {
    const auto line = lines.next();
    if (!line || lines.row(*line, kCsvSeparators).size() > 0) break;
  }
  if (table.rows > 0) readTextRows(lines, kCsvSeparators, table);
  return table;
}

/// The first column of one of these names, letters of either case.
const std::vector<double>* find(const Table& table, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      std::string lower = table.columns[c].name;
      std::transform(lower.begin(), lower.end(), lower.begin(),
                     [](unsigned char ch) { return static_cast<char>(std::tolower(ch)); });
      if (lower == name) return &table.values[c];
    }
  }
  return nullptr;
}

LidarCloud cloudOf(const std::string& path, const Table& table, const CloudFormat& format) {
  const auto toFloat = [](const std::vector<double>& in, double scale) {
    std::vector<float> out(in.size());
    for (std::size_t i = 0; i < in.size(); ++i) out[i] = static_cast<float>(in[i] * scale);
    return out;
  };
  LidarCloud cloud;
  const auto *x = find(table, {"x"}), *y = find(table, {"y"}), *z = find(table, {"z"});
  if (!x || !y || !z) {
    std::vector<std::string> names;
    for (const Column& c : table.columns) names.push_back(c.name);
    throw DataError(
        fmt::format("{}: columns {}: expected x, y and z", path, fmt::join(names, ", ")));
  }
  cloud.x = toFloat(*x, 1), cloud.y = toFloat(*y, 1), cloud.z = toFloat(*z, 1);
  if (const auto* v = find(table, {"intensity", "i", "reflectivity", "reflectance", "remission",
                                   "scalar_intensity"}))
    cloud.intensity = toFloat(*v, format.intensity_max > 0 ? 1 / format.intensity_max : 1);
  if (const auto* v = find(table, {"ring", "channel", "laser_id", "line"})) {
    cloud.ring.resize(v->size());
    for (std::size_t i = 0; i < v->size(); ++i)  // a ring that is none is 0
      cloud.ring[i] = static_cast<std::uint16_t>((*v)[i] >= 0 && (*v)[i] < 65536 ? (*v)[i] : 0);
  }
  if (const auto* v = find(table, {"time", "t", "time_offset", "timestamp"})) {
    const double begin = v->empty() ? 0 : v->front();
    cloud.time_offset.resize(v->size());
    for (std::size_t i = 0; i < v->size(); ++i)
      cloud.time_offset[i] = static_cast<float>(((*v)[i] - begin) * format.time_scale);
  }
  cloud.max_range = format.max_range;
  return cloud;
}

}  // namespace

const std::vector<std::string>& cloudEndings() {
  static const std::vector<std::string> kEndings = {".bin",    ".pcd",    ".ply",    ".csv",
                                                    ".txt",    ".xyz",    ".bin.gz", ".pcd.gz",
                                                    ".ply.gz", ".csv.gz", ".txt.gz", ".xyz.gz"};
  return kEndings;
}

LidarCloud readCloudFile(const std::string& path, const CloudFormat& format) {
  std::string name = path;
  if (name.size() > 3 && name.compare(name.size() - 3, 3, ".gz") == 0) name.resize(name.size() - 3);
  const std::string ending = name.size() < 4 ? "" : name.substr(name.size() - 4);
  const std::string bytes = readBytes(path, kMostBytes);
  if (ending == ".bin") return cloudOf(path, readBin(path, bytes, format), format);
  if (ending == ".pcd") return cloudOf(path, readPcd(path, bytes), format);
  if (ending == ".ply") return cloudOf(path, readPly(path, bytes), format);
  if (ending == ".csv" || ending == ".txt" || ending == ".xyz")
    return cloudOf(path, readCsvCloud(path, bytes, format), format);
  throw DataError(fmt::format("{}: expected one of {}", path, fmt::join(cloudEndings(), ", ")));
}

}  // namespace perception
