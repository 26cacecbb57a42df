#include <fmt/format.h>
#include <liblzf/lzf.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libperception/core/Error.h"
#include "libperception/importers/clouds/CloudTable.h"
#include "libperception/packets/Bytes.h"

namespace perception {
namespace {

std::size_t sizeAt(const char* bytes) {
  std::uint32_t value;
  std::memcpy(&value, bytes, sizeof(value));
  return value;
}

/// PCL's compression: columns one after the other, as one LZF block after two sizes.
void readCompressed(const std::string& path, std::string_view data, CloudTable& table) {
  checkSize(path, data.size(), 8);
  const auto packed = sizeAt(data.data());
  const auto unpacked = sizeAt(data.data() + 4);
  checkSize(path, data.size() - 8, packed);
  if (unpacked != table.rows * table.rowBytes())
    throw DataError(fmt::format("{}: {} bytes of points after unpacking, expected {}", path,
                                unpacked, table.rows * table.rowBytes()));
  if (unpacked == 0) return;
  std::string bytes(unpacked, '\0');
  if (lzf_decompress(data.data() + 8, static_cast<unsigned>(packed), bytes.data(),
                     static_cast<unsigned>(unpacked)) != unpacked)
    throw DataError(path + ": damaged LZF data");
  readColumns(bytes, false, table);
}

/// How many points a PCD header says there are.
struct PcdSize {
  std::optional<std::size_t> points, width, height;
};

/// One line of a PCD header: a word and its values, one a column.
void readPcdHeader(const TextRow& row, CloudTable& table, PcdSize& size) {
  const std::string key = row.text(0);
  const auto values = row.size() - 1;
  if (key == "FIELDS" || key == "COLUMNS") {
    table.columns.resize(values);
    for (std::size_t i = 0; i < values; ++i) table.columns[i].name = row.text(i + 1);
  } else if (key == "SIZE" || key == "TYPE" || key == "COUNT") {
    row.expect(values == table.columns.size(),
               fmt::format("{} and one for each of {} FIELDS", key, table.columns.size()));
    for (std::size_t i = 0; i < values; ++i) {
      CloudColumn& c = table.columns[i];
      if (key == "TYPE") {
        c.kind = row.text(i + 1).front();
      } else {
        (key == "SIZE" ? c.size : c.count) = static_cast<std::size_t>(row.frame(i + 1));
      }
    }
  } else if (key == "POINTS" || key == "WIDTH" || key == "HEIGHT") {
    (key == "POINTS"  ? size.points
     : key == "WIDTH" ? size.width
                      : size.height) = static_cast<std::size_t>(row.frame(1));
  }
}

struct PlyType {
  const char *name, *other;
  char kind;
  std::size_t size;
};

/// The type in a field of a line of the header.
const PlyType& plyType(const TextRow& row, std::size_t field) {
  static constexpr PlyType kTypes[] = {{"float", "float32", 'F', 4}, {"double", "float64", 'F', 8},
                                       {"char", "int8", 'I', 1},     {"uchar", "uint8", 'U', 1},
                                       {"short", "int16", 'I', 2},   {"ushort", "uint16", 'U', 2},
                                       {"int", "int32", 'I', 4},     {"uint", "uint32", 'U', 4}};
  for (const PlyType& type : kTypes) {
    if (row.text(field) == type.name || row.text(field) == type.other) return type;
  }
  row.fail(field, "a type of PLY");
}

/// "float32", "uchar" ... as a column.
CloudColumn plyColumn(const TextRow& row) {
  row.expect(row.size() == 3, "3 for a vertex: property TYPE NAME (no lists)");
  const PlyType& type = plyType(row, 1);
  return {row.text(2), type.kind, type.size, 1};
}

/// An element before the points, such as a camera: it is passed over.
struct PlyElement {
  struct Property {
    std::size_t count = 0;  ///< [bytes] of a list's number of values; 0: it is no list
    std::size_t value = 0;  ///< [bytes]
  };
  std::size_t count = 0;
  std::vector<Property> properties;

  void addProperty(const TextRow& row) {
    if (row.text(1) == "list")
      properties.push_back({plyType(row, 2).size, plyType(row, 3).size});
    else
      properties.push_back({0, plyType(row, 1).size});
  }
};

/// [bytes] of all of them. Throws DataError: they are not there.
std::size_t bytesOf(const PlyElement& element, const std::string& path, std::string_view data,
                    bool big_endian) {
  std::size_t at = 0;
  const auto pass = [&](std::uint64_t bytes) {
    if (bytes > data.size() - at) checkSize(path, data.size(), data.size() + 1);
    at += bytes;
  };
  for (std::size_t i = 0; i < element.count && !element.properties.empty(); ++i) {
    for (const PlyElement::Property& property : element.properties) {
      const std::size_t begin = at;
      pass(property.count);
      const std::uint64_t values = property.count == 0 ? 1
                                   : big_endian        ? bigEndian(data, begin, property.count)
                                                       : littleEndian(data, begin, property.count);
      pass(std::min<std::uint64_t>(values, data.size() + 1) * property.value);
    }
  }
  return at;
}

/// [bytes] that a point takes in the file at least.
double leastBytes(const CloudTable& table, const std::string& data) {
  constexpr double kLzf = 264.0 / 3;  // of the longest repetition that three bytes can name
  const double binary = std::max(1.0, static_cast<double>(table.rowBytes()));
  if (data == "ascii") return 2.0 * static_cast<double>(table.columns.size());  // digit, space
  return data == "binary_compressed" ? binary / kLzf : binary;
}

}  // namespace

CloudTable readPcd(const std::string& path, const std::string& bytes) {
  TextLines lines(path, bytes);
  CloudTable table;
  PcdSize size;
  std::string data;
  while (data.empty()) {
    const auto line = lines.next();
    if (!line) lines.fail("no line DATA, expected a PCD file");
    const TextRow row = lines.row(*line);
    if (row.size() == 0 || row.text(0).front() == '#') continue;
    if (row.text(0) == "DATA") {
      data = row.text(1);
    } else {
      readPcdHeader(row, table, size);
    }
  }
  if (table.columns.empty()) lines.fail("no line FIELDS before DATA, expected a PCD file");
  for (const CloudColumn& c : table.columns) {
    if (!c.isKnown())
      lines.fail(
          fmt::format("field {}: TYPE {} of SIZE {} is none of PCL's", c.name, c.kind, c.size));
  }
  // PCL's own files have all three; others have either.
  if (!size.points && size.width) size.points = *size.width * size.height.value_or(1);
  if (!size.points) lines.fail("no line POINTS or WIDTH before DATA");
  const std::size_t points = *size.points;
  checkCount(path, points);
  checkPromise(path, points, lines.rest().size(), leastBytes(table, data));
  table.resize(points);
  if (data == "ascii") {
    readTextRows(lines, kSpaces, table);
  } else if (data == "binary") {
    checkSize(path, lines.rest().size(), points * table.rowBytes());
    readRows(lines.rest(), false, table);
  } else if (data == "binary_compressed") {
    readCompressed(path, lines.rest(), table);
  } else {
    lines.fail(fmt::format("DATA {}, expected ascii, binary or binary_compressed", data));
  }
  return table;
}

std::optional<Pose3> pcdViewpoint(const std::string& path, const std::string& bytes) {
  TextLines lines(path, bytes);
  while (const auto line = lines.next()) {
    const TextRow row = lines.row(*line);
    if (row.size() > 0 && row.text(0) == "DATA") break;
    if (row.size() != 8 || row.text(0) != "VIEWPOINT") continue;
    for (std::size_t i = 1; i < row.size(); ++i)
      if (!row.isNumber(i)) return {};
    return poseFrom({row.real(1), row.real(2), row.real(3)},
                    {row.real(4), row.real(5), row.real(6), row.real(7)});
  }
  return {};
}

CloudTable readPly(const std::string& path, const std::string& bytes) {
  TextLines lines(path, bytes);
  CloudTable table;
  std::string format, element;
  std::optional<std::size_t> points;
  std::vector<PlyElement> before;
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
      const auto count = static_cast<std::size_t>(row.frame(2));
      if (element == "vertex") points = count;
      if (!points) before.push_back({count, {}});
    }
    if (key != "property") continue;
    if (element == "vertex")
      table.columns.push_back(plyColumn(row));
    else if (!points && !before.empty())
      before.back().addProperty(row);
  }
  if (!points || table.columns.empty()) lines.fail("no element vertex, expected points");
  checkCount(path, *points);
  checkPromise(path, *points, lines.rest().size(), leastBytes(table, format));
  table.resize(*points);
  if (format == "ascii") {
    for (const PlyElement& other : before)
      for (std::size_t i = 0; i < other.count; ++i)
        if (!lines.next()) lines.fail("the text ends before the points");
    readTextRows(lines, kSpaces, table);
  } else if (format == "binary_little_endian" || format == "binary_big_endian") {
    const bool big_endian = format == "binary_big_endian";
    std::string_view data = lines.rest();
    for (const PlyElement& other : before)
      data.remove_prefix(bytesOf(other, path, data, big_endian));
    checkSize(path, data.size(), *points * table.rowBytes());
    readRows(data, big_endian, table);
  } else {
    lines.fail(
        fmt::format("format '{}', expected ascii, binary_little_endian or "
                    "binary_big_endian",
                    format));
  }
  return table;
}

}  // namespace perception
