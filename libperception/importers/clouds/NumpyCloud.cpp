#include <fmt/format.h>
#include <fmt/ranges.h>
#include <minizip/unzip.h>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <regex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libperception/core/Error.h"
#include "libperception/importers/clouds/CloudTable.h"

namespace perception {
namespace {

// Files of numpy: https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html
constexpr std::string_view kNumpyMagic = "\x93NUMPY";
constexpr std::size_t kLongestHeader = 1U << 14;
constexpr std::size_t kMostArrayColumns = 64;
constexpr std::size_t kMostShort = 12;  // (assumed) longer: rows of points, not columns
constexpr std::uint64_t kMostArrayBytes = std::uint64_t{1} << 30;

/// One array of a file.
struct NumpyArray {
  std::string name;
  std::vector<std::size_t> shape;
  CloudTable table;  ///< columns of an array without names are "-"
  bool hasNames() const { return table.columns.front().name != "-"; }
  bool isCloud() const { return hasNames() || table.columns.size() >= 3; }
};

class NumpyHeader {
 public:
  NumpyHeader(const std::string& path, std::string_view bytes) : path_(path) {
    if (bytes.size() < 12 || bytes.substr(0, kNumpyMagic.size()) != kNumpyMagic)
      fail("expected a file of numpy (.npy)");
    const bool is_long = bytes[6] > 1;
    const auto byte = [&](std::size_t i) {
      return static_cast<std::size_t>(static_cast<unsigned char>(bytes[i]));
    };
    const std::size_t size =
        byte(8) | byte(9) << 8 | (is_long ? byte(10) << 16 | byte(11) << 24 : 0);
    begin_ = (is_long ? 12 : 10) + size;
    if (size > kLongestHeader || begin_ > bytes.size())
      fail(fmt::format("a header of {} bytes in {}", size, bytes.size()));
    text_ = std::string(bytes.substr(begin_ - size, size));
    readShape();
    readColumns();
  }
  std::size_t begin() const { return begin_; }
  const std::vector<std::size_t>& shape() const { return shape_; }
  const std::vector<CloudColumn>& columns() const { return columns_; }
  bool hasNames() const { return has_names_; }
  bool isFortran() const { return fortran_; }
  bool isSwapped() const { return order_ == '>'; }
  [[noreturn]] void fail(const std::string& message) const {
    throw DataError(fmt::format("{}: {}", path_, message));
  }

 private:
  static std::vector<std::size_t> numbersOf(const std::string& text) {
    std::vector<std::size_t> numbers;
    for (std::size_t at = 0; at < text.size();) {
      std::size_t value = 0;
      const auto result = std::from_chars(text.data() + at, text.data() + text.size(), value);
      if (result.ec == std::errc()) numbers.push_back(value);
      at = result.ec == std::errc() ? static_cast<std::size_t>(result.ptr - text.data()) : at + 1;
    }
    return numbers;
  }
  void readShape() {
    static const std::regex kShape(R"('shape':\s*\(([0-9, ]*)\))");
    std::smatch match;
    if (!std::regex_search(text_, match, kShape)) fail("no shape in its header");
    shape_ = numbersOf(match[1]);
    fortran_ = text_.find("'fortran_order': True") != std::string::npos;
  }
  void readColumns() {
    static const std::regex kPlain(R"('descr':\s*'([<>|=])([a-zA-Z])([0-9]{1,4})')");
    static const std::regex kField(
        R"(\(\s*'([^']*)',\s*'([<>|=])([a-zA-Z])([0-9]{1,4})'\s*(?:,\s*\(([0-9, ]*)\)\s*)?\))");
    std::smatch match;
    if (std::regex_search(text_, match, kPlain)) return add("-", match[1], match[2], match[3], 1);
    for (std::sregex_iterator it(text_.begin(), text_.end(), kField), end; it != end; ++it) {
      std::size_t count = 1;
      for (const std::size_t n : numbersOf((*it)[5])) count *= std::min<std::size_t>(n, 5000);
      add((*it)[1], (*it)[2], (*it)[3], (*it)[4], count);
    }
    has_names_ = true;
    if (columns_.empty()) fail("the type of its numbers is not known: " + text_);
  }
  /// One column of each row, by numpy's letters.
  void add(std::string name, const std::string& order, const std::string& kind,
           const std::string& size, std::size_t count) {
    CloudColumn column{std::move(name), 'F', static_cast<std::size_t>(std::stoul(size)), count};
    if (kind == "i") column.kind = 'I';
    if (kind == "u" || kind == "b") column.kind = 'U';
    if (kind == "V") column = {"padding", 'U', 1, column.size * count};
    if (std::string("fiubV").find(kind) == std::string::npos || !column.isKnown())
      fail(
          fmt::format("numbers of numpy's type '{}{}', expected floats of 4 or 8 bytes, or whole "
                      "numbers",
                      kind, size));
    if (order == "<" || order == ">") {
      if (order_ != 0 && order_ != order[0]) fail("numbers of both byte orders");
      order_ = order[0];
    }
    columns_.push_back(std::move(column));
  }

  const std::string& path_;
  std::string text_;
  std::size_t begin_ = 0;
  std::vector<std::size_t> shape_;
  std::vector<CloudColumn> columns_;
  bool fortran_ = false, has_names_ = false;
  char order_ = 0;
};

/// Rows of points, or columns of them where the first side of the array is the short one.
NumpyArray readArray(const std::string& path, std::string_view bytes) {
  const NumpyHeader header(path, bytes);
  NumpyArray array;
  array.shape = header.shape();
  array.table.columns = header.columns();
  std::size_t rows = 1, columns = 1;
  bool by_column = header.isFortran();
  const auto& shape = array.shape;
  if (!header.hasNames() && shape.size() >= 2) {
    const bool lies = shape.size() == 2 && shape[0] <= kMostShort && shape[1] > kMostShort;
    columns = lies ? shape[0] : shape.back();
    by_column = by_column != lies;
  }
  for (const std::size_t n : shape) checkCount(path, n), checkCount(path, rows *= n);
  if (columns == 0 || columns > kMostArrayColumns)
    header.fail(
        fmt::format("an array of ({}), expected rows of x, y, z, ...", fmt::join(shape, ", ")));
  rows /= columns;
  const CloudColumn first = array.table.columns.front();
  array.table.columns.resize(array.table.columns.size() * columns, first);
  const std::string_view data = bytes.substr(header.begin());
  checkSize(path, data.size(), rows * array.table.rowBytes());
  array.table.resize(rows);
  if (by_column && !header.hasNames())
    readColumns(data, header.isSwapped(), array.table);
  else
    readRows(data, header.isSwapped(), array.table);
  return array;
}

using NumpyZip = std::unique_ptr<void, int (*)(unzFile)>;

/// The bytes of the entry that the archive is at.
std::string readEntry(const std::string& path, const std::string& name, unzFile zip) {
  std::string bytes;
  int got = unzOpenCurrentFile(zip) == UNZ_OK ? 1 : -1;
  for (std::size_t block = 1U << 16; got > 0; block = std::min<std::size_t>(2 * block, 1U << 22)) {
    const std::size_t begin = bytes.size();
    if (begin > kMostArrayBytes) break;
    bytes.resize(begin + block);
    got = unzReadCurrentFile(zip, bytes.data() + begin, static_cast<unsigned>(block));
    bytes.resize(begin + static_cast<std::size_t>(std::max(got, 0)));
  }
  if (got != 0 || unzCloseCurrentFile(zip) != UNZ_OK)
    throw DataError(fmt::format("{}: {} in it is damaged, or of more than 1 GiB", path, name));
  return bytes;
}

/// The arrays of an archive; `unread`: what is wrong with the others.
std::vector<NumpyArray> readArrays(const std::string& path, std::vector<std::string>& unread) {
  const NumpyZip zip(unzOpen64(path.c_str()), &unzClose);
  if (!zip) throw DataError(path + ": expected an archive of numpy (.npz)");
  std::vector<NumpyArray> arrays;
  for (int at = unzGoToFirstFile(zip.get()); at == UNZ_OK; at = unzGoToNextFile(zip.get())) {
    char name[256] = {};
    unzGetCurrentFileInfo64(zip.get(), nullptr, name, sizeof(name) - 1, nullptr, 0, nullptr, 0);
    const std::string bytes = readEntry(path, name, zip.get());
    try {
      NumpyArray array = readArray(path + ": " + name, bytes);
      array.name = name;
      array.name = array.name.substr(0, array.name.rfind(".npy"));
      arrays.push_back(std::move(array));
    } catch (const DataError& e) {
      unread.emplace_back(e.what());
    }
  }
  return arrays;
}

void addColumn(const NumpyArray& from, CloudTable& to) {
  to.columns.push_back(from.table.columns.front());
  to.columns.back().name = from.name;
  to.values.push_back(from.table.values.front());
}

}  // namespace

CloudTable readNpy(const std::string& path, const std::string& bytes) {
  NumpyArray array = readArray(path, bytes);
  if (!array.isCloud())
    throw DataError(fmt::format("{}: an array of ({}), expected rows of x, y, z, ...", path,
                                fmt::join(array.shape, ", ")));
  return std::move(array.table);
}

CloudTable readNpz(const std::string& path) {
  std::vector<std::string> unread, names;
  const std::vector<NumpyArray> arrays = readArrays(path, unread);
  CloudTable table;
  std::size_t clouds = 0;
  for (const NumpyArray& array : arrays) {
    names.push_back(fmt::format("{} ({})", array.name, fmt::join(array.shape, ", ")));
    if (array.isCloud() && clouds++ == 0) table = array.table;
  }
  if (clouds > 1)
    throw DataError(fmt::format("{}: {} arrays can be the points: {}: expected one", path, clouds,
                                fmt::join(names, ", ")));
  if (clouds == 1 && table.columns.size() == 3 && table.columns.front().name == "-")
    for (std::size_t i = 0; i < 3; ++i) table.columns[i].name = std::string(1, "xyz"[i]);
  for (const NumpyArray& array : arrays) {
    const bool is_column = array.shape.size() == 1 && !array.isCloud();
    if (!is_column || (!table.columns.empty() && array.table.rows != table.rows)) continue;
    table.rows = array.table.rows;
    addColumn(array, table);
  }
  if (table.columns.empty())
    throw DataError(fmt::format("{}: none of its arrays is a cloud: {}", path,
                                fmt::join(names.empty() ? unread : names, ", ")));
  return table;
}

}  // namespace perception
