#include "libperception/importers/ImportClouds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "libperception/core/Error.h"
#include "libperception/importers/CloudTable.h"
#include "libperception/importers/ImportText.h"

namespace perception {
namespace {

constexpr std::size_t kMostBytes = std::size_t{1} << 30;

CloudTable readBin(const std::string& path, const std::string& bytes, const CloudFormat& format) {
  CloudTable table;
  for (const std::string& name : format.columns) table.columns.push_back({name});
  const std::size_t row = table.rowBytes();
  if (row == 0 || bytes.size() % row != 0) {
    throw DataError(fmt::format("{}: {} bytes, expected {} a point (float32 {})", path,
                                bytes.size(), row, fmt::join(format.columns, ", ")));
  }
  table.resize(bytes.size() / row);
  readRows(bytes, false, table);
  return table;
}

constexpr const char* kCsvSeparators = ",; \t\r";

CloudTable readCsvCloud(const std::string& path, const std::string& bytes,
                        const CloudFormat& format) {
  CloudTable table;
  TextLines counter(path, bytes);
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
  TextLines lines(path, bytes);
  while (has_names) {
    const auto line = lines.next();
    if (!line || lines.row(*line, kCsvSeparators).size() > 0) break;
  }
  if (table.rows > 0) readTextRows(lines, kCsvSeparators, table);
  return table;
}

/// The first column of one of these names, letters of either case.
const std::vector<double>* find(const CloudTable& table, std::initializer_list<const char*> names) {
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

LidarCloud cloudOf(const std::string& path, const CloudTable& table, const CloudFormat& format) {
  const auto toFloat = [](const std::vector<double>& in, double scale) {
    std::vector<float> out(in.size());
    for (std::size_t i = 0; i < in.size(); ++i) out[i] = static_cast<float>(in[i] * scale);
    return out;
  };
  LidarCloud cloud;
  const auto *x = find(table, {"x"}), *y = find(table, {"y"}), *z = find(table, {"z"});
  if (!x || !y || !z) {
    std::vector<std::string> names;
    for (const CloudColumn& c : table.columns) names.push_back(c.name);
    throw DataError(
        fmt::format("{}: columns {}: expected x, y and z", path, fmt::join(names, ", ")));
  }
  cloud.x = toFloat(*x, 1), cloud.y = toFloat(*y, 1), cloud.z = toFloat(*z, 1);
  if (const auto* v = find(table, {"intensity", "i", "reflectivity", "reflectance", "remission",
                                   "scalar_intensity"}))
    cloud.intensity = toFloat(*v, format.intensity_max > 0 ? 1 / format.intensity_max : 1);
  if (const auto* v = find(table, {"ring", "channel", "laser_id", "line"})) {
    cloud.ring.resize(v->size());
    for (std::size_t i = 0; i < v->size(); ++i)  // invalid rings become 0
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

LidarCloud inFrame(LidarCloud cloud, const Pose3& T_to_from) {
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3f p =
        (T_to_from * Vector3(cloud.x[i], cloud.y[i], cloud.z[i])).cast<float>();
    cloud.x[i] = p.x(), cloud.y[i] = p.y(), cloud.z[i] = p.z();
  }
  return cloud;
}

}  // namespace perception
