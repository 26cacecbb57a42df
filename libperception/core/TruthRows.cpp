#include "libperception/core/TruthRows.h"

#include <cmath>
#include <limits>

namespace perception {
namespace {

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

}  // namespace

void requireTruthColumns(const CsvTable& csv) {
  for (std::string_view rest = kTruthHeader; !rest.empty();) {
    const std::size_t end = rest.find_first_of(",\n");
    csv.column(rest.substr(0, end));
    rest.remove_prefix(end + 1);
  }
}

TruthObject readTruthRow(const CsvTable& csv, std::size_t row) {
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
  if (csv.has(kTruthAreaColumns[0])) {
    std::array<double, 4> edges;
    for (std::size_t k = 0; k < 4; ++k)
      edges[k] = csv.realOrNan(row, csv.column(kTruthAreaColumns[k]));
    if (!std::isnan(edges[0] + edges[1] + edges[2] + edges[3]))
      o.area = ImageArea{edges[0], edges[1], edges[2], edges[3]};
  }
  return o;
}

void TruthOrder::add(const TruthObject& object, const CsvTable& csv, std::size_t row) {
  if (!begun_ || object.t != t_) {
    ids_.clear();
    if (object.frame >= 0 && !frames_.insert(object.frame).second) {
      csv.fault(row, csv.column("frame"), "one time t for all lines of a frame");
    }
  } else if (object.frame != frame_) {
    csv.fault(row, csv.column("frame"), "one frame number for all lines of a time t");
  }
  if (object.id >= 0 && !ids_.insert(object.id).second) {
    csv.fault(row, csv.column("id"), "an object once per time t");
  }
  begun_ = true;
  t_ = object.t;
  frame_ = object.frame;
}

}  // namespace perception
