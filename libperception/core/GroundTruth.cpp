#include "libperception/core/GroundTruth.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <limits>
#include <memory>
#include <set>
#include <string_view>
#include <utility>

#include "libperception/core/Csv.h"
#include "libperception/core/Error.h"
#include "libperception/core/system/PartialFile.h"

namespace perception {
namespace {

constexpr std::string_view kHeader =
    "frame,t,id,class,x,y,z,yaw,length,width,height,vx,vy,truncated,occluded,lidar_points,ignore\n";

// Columns of an area of the image, after those; in files that have such areas.
constexpr std::array<std::string_view, 4> kAreaColumns = {"image_left", "image_top", "image_right",
                                                          "image_bottom"};

// A row without a position is accepted only with the ignore flag (KITTI's DontCare is an area of
// the image).
double place(const CsvTable& csv, std::size_t row, std::string_view column, bool ignore) {
  const CsvTable::Column c = csv.column(column);
  return ignore ? csv.realOrNan(row, c) : csv.real(row, c);
}

double size(const CsvTable& csv, std::size_t row, std::string_view column) {
  const CsvTable::Column c = csv.column(column);
  const double value = csv.realOrNan(row, c);
  if (value < 0) csv.fault(row, c, "a size of at least 0 m");
  return value;
}

int small(const CsvTable& csv, std::size_t row, std::string_view column, int when_empty) {
  const CsvTable::Column c = csv.column(column);
  const std::int64_t value = csv.integerOr(row, c, when_empty);
  if (value < -1 || value > std::numeric_limits<int>::max()) {
    csv.fault(row, c, "an integer of at least 0, -1 or nothing");
  }
  return static_cast<int>(value);
}

TruthObject readRow(const CsvTable& csv, std::size_t row) {
  TruthObject o;
  o.ignore = csv.flag(row, csv.column("ignore"));
  o.frame = csv.integerOr(row, csv.column("frame"), -1);
  o.t = csv.real(row, csv.column("t"));
  o.id = csv.integerOr(row, csv.column("id"), -1);
  o.type = csv.text(row, csv.column("class"));
  if (o.type.empty()) csv.fault(row, csv.column("class"), "a class such as Car or Pedestrian");
  o.position = {place(csv, row, "x", o.ignore), place(csv, row, "y", o.ignore),
                csv.realOrNan(row, csv.column("z"))};
  o.yaw = csv.realOrNan(row, csv.column("yaw"));
  o.length = size(csv, row, "length");
  o.width = size(csv, row, "width");
  o.height = size(csv, row, "height");
  o.vx = csv.realOrNan(row, csv.column("vx"));
  o.vy = csv.realOrNan(row, csv.column("vy"));
  const double truncated = csv.realOrNan(row, csv.column("truncated"));
  o.truncated = std::isnan(truncated) ? 0 : truncated;
  o.occluded = small(csv, row, "occluded", 0);
  o.lidar_points = small(csv, row, "lidar_points", -1);
  if (csv.has(kAreaColumns[0])) {
    std::array<double, 4> edges;
    for (std::size_t k = 0; k < 4; ++k) edges[k] = csv.realOrNan(row, csv.column(kAreaColumns[k]));
    if (!std::isnan(edges[0] + edges[1] + edges[2] + edges[3]))
      o.area = ImageArea{edges[0], edges[1], edges[2], edges[3]};
  }
  return o;
}

// Rows of one instant share frame and time; an object id occurs once.
void checkInstants(const std::vector<std::pair<TruthObject, std::size_t>>& rows,
                   const CsvTable& csv) {
  std::set<std::int64_t> frames, ids;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& [object, row] = rows[i];
    const bool new_instant = i == 0 || object.t != rows[i - 1].first.t;
    if (new_instant) {
      ids.clear();
      if (object.frame >= 0 && !frames.insert(object.frame).second) {
        csv.fault(row, csv.column("frame"), "one time t for all lines of a frame");
      }
    } else if (object.frame != rows[i - 1].first.frame) {
      csv.fault(row, csv.column("frame"), "one frame number for all lines of a time t");
    }
    if (object.id >= 0 && !ids.insert(object.id).second) {
      csv.fault(row, csv.column("id"), "an object once per time t");
    }
  }
}

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
  // Reports a missing column even when the file has no row.
  for (std::string_view rest = kHeader; !rest.empty();) {
    const std::size_t end = rest.find_first_of(",\n");
    csv.column(rest.substr(0, end));
    rest.remove_prefix(end + 1);
  }
  std::vector<std::pair<TruthObject, std::size_t>> rows;
  for (std::size_t row = 0; row < csv.rows(); ++row) rows.emplace_back(readRow(csv, row), row);
  std::stable_sort(rows.begin(), rows.end(),
                   [](const auto& a, const auto& b) { return a.first.t < b.first.t; });
  checkInstants(rows, csv);
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
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  PartialFile partial(path);
  std::unique_ptr<std::FILE, Closer> file(std::fopen(partial.path().c_str(), "wbe"));
  if (!file) {
    throw OutputError(fmt::format("{}: cannot be created: {}", path, std::strerror(errno)));
  }
  const bool areas = std::any_of(rows.begin(), rows.end(), [](auto& o) { return o.area; });
  std::string text(kHeader);
  if (areas) {
    text.pop_back();
    for (const std::string_view column : kAreaColumns) text.append(",").append(column);
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
