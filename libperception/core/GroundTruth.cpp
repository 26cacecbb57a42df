#include "libperception/core/GroundTruth.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string_view>
#include <utility>

#include "libperception/core/Csv.h"
#include "libperception/core/Error.h"
#include "libperception/core/TruthRows.h"
#include "libperception/core/system/PartialFile.h"

namespace perception {
namespace {

// A number with four decimal places [0.1 mm]; nothing where it is unknown; zero without sign.
std::string decimal(double value) {
  if (!std::isfinite(value)) return "";
  const std::string text = fmt::format("{:.4f}", value);
  return text == "-0.0000" ? text.substr(1) : text;
}

std::string areaFields(const std::optional<ImageArea>& area) {
  return area ? fmt::format(",{:.2f},{:.2f},{:.2f},{:.2f}", area->left, area->top, area->right,
                            area->bottom)
              : ",,,,";
}

std::string line(const TruthObject& o) {
  const auto count = [](std::int64_t n) { return n < 0 ? std::string() : fmt::format("{}", n); };
  // Times to the nanosecond, so that they match those of the run; yaw to a microradian.
  return fmt::format("{},{:.9f},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}", count(o.frame), o.t,
                     count(o.id), o.type, decimal(o.position.x()), decimal(o.position.y()),
                     decimal(o.position.z()),
                     std::isfinite(o.yaw) ? fmt::format("{:.6f}", o.yaw) : "", decimal(o.length),
                     decimal(o.width), decimal(o.height), decimal(o.vx), decimal(o.vy),
                     decimal(o.truncated), o.occluded, count(o.lidar_points), o.ignore ? 1 : 0);
}

}  // namespace

GroundTruth readGroundTruth(const std::string& path) {
  const CsvTable csv = CsvTable::fromFile(path);
  requireTruthColumns(csv);
  std::vector<std::pair<TruthObject, std::size_t>> rows;
  for (std::size_t row = 0; row < csv.rows(); ++row) rows.emplace_back(readTruthRow(csv, row), row);
  std::stable_sort(rows.begin(), rows.end(),
                   [](const auto& a, const auto& b) { return a.first.t < b.first.t; });
  TruthOrder order;
  for (const auto& [object, row] : rows) order.add(object, csv, row);
  GroundTruth truth;
  for (auto& [object, row] : rows) {
    if (truth.instants.empty() || truth.instants.back().t != object.t) {
      truth.instants.push_back({object.frame, object.t, {}});
    }
    truth.instants.back().objects.push_back(std::move(object));
  }
  return truth;
}

std::string truthFileOf(const std::string& rawlog) {
  std::filesystem::path path(rawlog);
  if (path.extension() == ".rawlog") path.replace_extension();
  return path.string() + ".truth.csv";
}

std::string labelFolderOf(const std::string& rawlog) {
  return std::filesystem::path(rawlog).replace_extension().string() + "_Labels";
}

GroundTruth truthBeside(const std::string& rawlog) { return readGroundTruth(truthFileOf(rawlog)); }

void writeGroundTruth(const std::string& path, const std::vector<TruthObject>& rows) {
  PartialFile partial(path);
  std::unique_ptr<std::FILE, FileCloser> file(std::fopen(partial.path().c_str(), "wbe"));
  if (!file) {
    throw OutputError(fmt::format("{}: cannot be created: {}", path, std::strerror(errno)));
  }
  const bool areas = std::any_of(rows.begin(), rows.end(), [](auto& o) { return o.area; });
  std::string text(kTruthHeader);
  if (areas) {
    text.pop_back();
    for (const std::string_view column : kTruthAreaColumns) text.append(",").append(column);
    text += '\n';
  }
  for (const TruthObject& row : rows)
    text.append(line(row)).append(areas ? areaFields(row.area) : "").append("\n");
  errno = 0;
  const bool written = std::fwrite(text.data(), 1, text.size(), file.get()) == text.size();
  if (!written || std::fflush(file.get()) != 0 || ::fsync(::fileno(file.get())) != 0 ||
      std::fclose(file.release()) != 0) {
    throw OutputError(fmt::format("{}: cannot be written: {}", path, std::strerror(errno)),
                      ExitCode::kIoError);
  }
  partial.commit();
}

}  // namespace perception
