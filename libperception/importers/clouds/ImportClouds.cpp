#include "libperception/importers/clouds/ImportClouds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <iterator>
#include <string_view>

#include "libperception/core/Error.h"
#include "libperception/importers/ImportText.h"
#include "libperception/importers/clouds/CloudLayout.h"
#include "libperception/importers/clouds/CloudTable.h"
#include "libperception/measurement/frames/ScanTimes.h"

namespace perception {
namespace {

constexpr std::size_t kMostBytes = std::size_t{1} << 30;

/// Fewer returns do not tell what their columns are.
constexpr std::size_t kLeastReturns = 100;

/// `format` with the columns of a layout.
CloudFormat withLayout(CloudFormat format, const CloudLayout& layout) {
  format.columns = layout.columns;
  if (format.intensity_max <= 0) format.intensity_max = layout.intensity_max;
  return format;
}

constexpr const char* kSayColumns =
    "say them: --columns x,y,z,intensity, \"-\" for what is skipped";

CloudTable binTable(const std::string& path, const std::string& bytes, std::size_t columns,
                    bool doubles) {
  CloudTable table;
  table.columns.assign(columns, {"-", 'F', doubles ? sizeof(double) : sizeof(float)});
  const std::size_t row = table.rowBytes();
  if (row == 0 || bytes.size() % row != 0) {
    throw DataError(
        fmt::format("{}: {} bytes, expected {} a point ({} {}): {} are left from "
                    "byte {} on",
                    path, bytes.size(), row, columns, doubles ? "float64" : "float32",
                    row == 0 ? 0 : bytes.size() % row, row == 0 ? 0 : bytes.size() / row * row));
  }
  table.resize(bytes.size() / row);
  readRows(bytes, false, table);
  return table;
}

/// The numbers of the first files, of as many as are needed to tell their columns.
std::string firstNumbers(const std::vector<std::string>& paths) {
  constexpr std::size_t kEnough = kLeastReturns * kMostCloudColumns * sizeof(float);
  std::string numbers;
  for (const std::string& path : paths) {
    if (numbers.size() >= kEnough) break;
    const std::string bytes = readBytes(path, kMostBytes);
    numbers.append(bytes, 0, bytes.size() / sizeof(float) * sizeof(float));
  }
  return numbers;
}

/// Numbers of float32 or float64.
std::vector<float> numbersIn(const std::string& bytes, bool doubles) {
  const auto read = [&](auto zero) {
    std::vector<decltype(zero)> numbers(bytes.size() / sizeof(zero));
    if (!numbers.empty()) std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(zero));
    return std::vector<float>(numbers.begin(), numbers.end());
  };
  return doubles ? read(0.0) : read(0.0F);
}

/// A file that does not end with a row is refused where it is read.
CloudFormat foundBinFormat(const std::vector<std::string>& paths, const CloudFormat& given) {
  CloudFormat format = given;
  std::string bytes = firstNumbers(paths);
  format.doubles = looksLikeDoubles(bytes);
  if (!format.columns.empty()) return format;
  const std::size_t size = format.doubles ? sizeof(double) : sizeof(float);
  const char* const kind = format.doubles ? "float64" : "float32";
  const std::vector<float> numbers = numbersIn(bytes, format.doubles);
  const auto columns = columnCountOf(numbers);
  if (!columns)
    throw DataError(fmt::format("{}: its {} numbers do not tell how many columns it has; {}",
                                paths.front(), numbers.size(), kSayColumns));
  bytes.resize(numbers.size() / *columns * *columns * size);
  const auto layout = layoutOf(binTable(paths.front(), bytes, *columns, format.doubles).values);
  if (!layout)
    throw DataError(fmt::format("{}: none of its {} columns of {} can be x, y and z [m]; {}",
                                paths.front(), *columns, kind, kSayColumns));
  return withLayout(format, *layout);
}

CloudTable readBin(const std::string& path, const std::string& bytes, const CloudFormat& given) {
  const CloudFormat format = given.columns.empty() ? foundBinFormat({path}, given) : given;
  CloudTable table = binTable(path, bytes, format.columns.size(), format.doubles);
  for (std::size_t c = 0; c < format.columns.size(); ++c) table.columns[c].name = format.columns[c];
  return table;
}

/// Whether rows are read before it is known what they hold: text, and arrays of numpy.
bool isTable(const std::string& ending) {
  return ending == ".csv" || ending == ".txt" || ending == ".xyz" || ending == ".npy" ||
         ending == ".npz";
}

CloudTable readTable(const std::string& path, const std::string& bytes) {
  const std::string ending = cloudEndingOf(path);
  return ending == ".npz"   ? readNpz(path)
         : ending == ".npy" ? readNpy(path, bytes)
                            : readCsv(path, bytes);
}

/// How many columns have no names: the first ones.
std::size_t namelessOf(const CloudTable& table) {
  return static_cast<std::size_t>(
      std::count_if(table.columns.begin(), table.columns.end(),
                    [](const CloudColumn& column) { return column.name == "-"; }));
}

/// Of files without names; of as many as are needed.
CloudFormat foundTableFormat(const std::vector<std::string>& paths, const CloudFormat& format) {
  std::vector<std::vector<double>> values;
  for (const std::string& path : paths) {
    if (!values.empty() && values.front().size() >= kLeastReturns) break;
    const CloudTable table = readTable(path, readBytes(path, kMostBytes));
    const std::size_t nameless = namelessOf(table);
    if (nameless == 0 && !table.columns.empty()) return format;
    if (values.empty()) values.resize(nameless);
    for (std::size_t c = 0; c < std::min(values.size(), nameless); ++c)
      values[c].insert(values[c].end(), table.values[c].begin(), table.values[c].end());
  }
  if (values.empty() || values.front().size() < kLeastReturns)
    throw DataError(fmt::format("{}: {} returns do not tell what their columns are; {}",
                                paths.front(), values.empty() ? 0 : values.front().size(),
                                kSayColumns));
  const auto layout = layoutOf(values);
  if (!layout)
    throw DataError(fmt::format("{}: none of its {} columns can be x, y and z [m]; {}",
                                paths.front(), values.size(), kSayColumns));
  return withLayout(format, *layout);
}

CloudTable readNamedTable(const std::string& path, const std::string& bytes,
                          const CloudFormat& given) {
  CloudTable table = readTable(path, bytes);
  const std::size_t nameless = namelessOf(table);
  if (nameless == 0 && !table.columns.empty()) return table;
  const CloudFormat format = given.columns.empty() ? foundTableFormat({path}, given) : given;
  if (table.rows > 0 && nameless < format.columns.size())
    throw DataError(fmt::format("{}{}: {} fields, expected {}: {}", path, table.place, nameless,
                                format.columns.size(), fmt::join(format.columns, ", ")));
  if (table.rows == 0) table.columns.assign(format.columns.size(), {"-"}), table.resize(0);
  for (std::size_t c = 0; c < format.columns.size(); ++c) table.columns[c].name = format.columns[c];
  return table;
}

/// The column that has one of the names of what is looked for.
const std::vector<double>* find(const CloudTable& table, std::string_view what) {
  for (std::size_t c = 0; c < table.columns.size(); ++c)
    if (isCloudColumn(table.columns[c].name, what)) return &table.values[c];
  return nullptr;
}

/// The numbers of a coordinate. Throws DataError: it has no known unit.
const std::vector<double>* findCoordinate(const std::string& path, const CloudTable& table,
                                          std::string_view what) {
  const auto* const values = find(table, what);
  for (std::size_t c = 0; c < table.columns.size(); ++c)
    if (&table.values[c] == values && table.columns[c].kind != 'F')
      throw DataError(path + ": x, y and z are whole numbers, whose unit is not said");
  return values;
}

LidarCloud cloudOf(const std::string& path, const CloudTable& table, const CloudFormat& format) {
  const auto toFloat = [](const std::vector<double>& in, double scale) {
    std::vector<float> out(in.size());
    for (std::size_t i = 0; i < in.size(); ++i) out[i] = static_cast<float>(in[i] * scale);
    return out;
  };
  LidarCloud cloud;
  const auto coordinate = [&](const char* name) { return findCoordinate(path, table, name); };
  const auto *x = coordinate("x"), *y = coordinate("y"), *z = coordinate("z");
  if (!x || !y || !z) {
    std::vector<std::string> names;
    for (const CloudColumn& c : table.columns) names.push_back(c.name);
    throw DataError(
        fmt::format("{}: columns {}: expected x, y and z", path, fmt::join(names, ", ")));
  }
  cloud.x = toFloat(*x, 1), cloud.y = toFloat(*y, 1), cloud.z = toFloat(*z, 1);
  if (const auto* v = find(table, "intensity"))
    cloud.intensity = toFloat(*v, format.intensity_max > 0 ? 1 / format.intensity_max : 1);
  if (const auto* v = find(table, "ring")) {
    cloud.ring.resize(v->size());
    for (std::size_t i = 0; i < v->size(); ++i)  // invalid rings become 0
      cloud.ring[i] = static_cast<std::uint16_t>((*v)[i] >= 0 && (*v)[i] < 65536 ? (*v)[i] : 0);
  }
  if (const auto* v = find(table, "time")) {
    const double begin = format.about_stamp ? 0 : earliestOf(*v, cloud);
    cloud.time_offset.resize(v->size());
    for (std::size_t i = 0; i < v->size(); ++i)
      cloud.time_offset[i] = static_cast<float>(((*v)[i] - begin) * format.time_scale);
  }
  cloud.max_range = format.max_range;
  return cloud;
}

}  // namespace

const std::vector<std::string>& cloudEndings() {
  static const std::vector<std::string> kEndings = {
      ".bin",    ".pcd",    ".ply",    ".csv",    ".txt",    ".xyz",    ".npy",   ".npz",
      ".bin.gz", ".pcd.gz", ".ply.gz", ".csv.gz", ".txt.gz", ".xyz.gz", ".npy.gz"};
  return kEndings;
}

/// ".bin" of "a/0001.bin.gz".
std::string cloudEndingOf(const std::string& path) {
  std::string name = path;
  if (name.size() > 3 && name.compare(name.size() - 3, 3, ".gz") == 0) name.resize(name.size() - 3);
  return name.size() < 4 ? "" : name.substr(name.size() - 4);
}

CloudFormat foundFormat(const std::vector<std::string>& paths, const CloudFormat& format) {
  if (paths.empty()) return format;
  const std::string ending = cloudEndingOf(paths.front());
  if (!format.columns.empty() && ending != ".bin") return format;
  std::vector<std::string> alike;
  std::copy_if(paths.begin(), paths.end(), std::back_inserter(alike),
               [&](const std::string& path) { return cloudEndingOf(path) == ending; });
  if (ending == ".bin") return foundBinFormat(alike, format);
  return isTable(ending) ? foundTableFormat(alike, format) : format;
}

LidarCloud readCloudFile(const std::string& path, const CloudFormat& format) {
  const std::string ending = cloudEndingOf(path);
  const std::string bytes = readBytes(path, kMostBytes);
  if (ending == ".bin") return cloudOf(path, readBin(path, bytes, format), format);
  if (ending == ".pcd") return cloudOf(path, readPcd(path, bytes), format);
  if (ending == ".ply") return cloudOf(path, readPly(path, bytes), format);
  if (isTable(ending)) return cloudOf(path, readNamedTable(path, bytes, format), format);
  throw DataError(fmt::format("{}: expected one of {}", path, fmt::join(cloudEndings(), ", ")));
}

std::optional<Pose3> viewpointOf(const std::string& path) {
  if (cloudEndingOf(path) != ".pcd") return {};
  return pcdViewpoint(path, readBytes(path, kMostBytes));
}

LidarCloud inFrame(LidarCloud cloud, const Pose3& T_to_from) {
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3f p =
        (T_to_from * Vector3(cloud.x[i], cloud.y[i], cloud.z[i])).cast<float>();
    cloud.x[i] = p.x(), cloud.y[i] = p.y(), cloud.z[i] = p.z();
  }
  return cloud;
}

}  // namespace perception
