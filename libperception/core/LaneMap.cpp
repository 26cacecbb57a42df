#include "libperception/core/LaneMap.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "libperception/core/Csv.h"

namespace perception {
namespace {

constexpr double kCell = 10;          // [m] cell size of the spatial index
constexpr double kLeastStep = 1e-3;   // [m] between points of a lane
constexpr double kLongestStep = 1e3;  // [m] the same
constexpr double kFarthest = 2e7;     // [m] a pole in UTM, with a margin

/// The point of the segment a-b nearest to p.
struct Foot {
  double distance;  // [m]
  double offset;    // [m] to the left
};
Foot footOf(const Vector2& a, const Vector2& b, const Vector2& p) {
  const Vector2 along = (b - a).normalized();
  const double s = std::clamp(along.dot(p - a), 0.0, (b - a).norm());
  const Vector2 d = p - (a + s * along);
  return {d.norm(), along.x() * d.y() - along.y() * d.x()};
}

}  // namespace

std::int64_t LaneMap::cellOf(double x, double y) {
  const auto i = static_cast<std::int64_t>(std::floor(x / kCell));
  const auto j = static_cast<std::int64_t>(std::floor(y / kCell));
  return i * (std::int64_t{1} << 32) + j;
}

LaneMap::LaneMap(std::vector<Lane> lanes) : lanes_(std::move(lanes)) {
  for (std::uint32_t l = 0; l < lanes_.size(); ++l) {
    const Lane& lane = lanes_[l];
    for (std::uint32_t k = 0; k + 1 < lane.points.size(); ++k) {
      const Vector2& a = lane.points[k];
      const Vector2& b = lane.points[k + 1];
      // Every cell that the segment's strip may touch, found by walking along it.
      const double length = (b - a).norm(), half = 0.5 * lane.width;
      std::set<std::int64_t> touched;
      const int steps = 1 + static_cast<int>(length / kCell);
      for (int i = 0; i <= steps; ++i) {
        const Vector2 p = a + (b - a) * (static_cast<double>(i) / steps);
        for (double x = p.x() - half - kCell; x <= p.x() + half + kCell; x += kCell) {
          for (double y = p.y() - half - kCell; y <= p.y() + half + kCell; y += kCell)
            touched.insert(cellOf(x, y));
        }
        touched.insert(cellOf(p.x() + half + kCell, p.y() + half + kCell));
      }
      for (const std::int64_t cell : touched) cells_[cell].push_back({l, k});
    }
  }
}

std::vector<LanePlace> LaneMap::at(const Vector2& place) const {
  struct Found {
    double distance;
    LanePlace place;
  };
  std::vector<Found> found;
  if (!place.allFinite()) return {};
  const auto cell = cells_.find(cellOf(place.x(), place.y()));
  if (cell == cells_.end()) return {};
  for (const Segment& s : cell->second) {
    const Lane& lane = lanes_[s.lane];
    const Vector2 &a = lane.points[s.first], &b = lane.points[s.first + 1];
    const Foot foot = footOf(a, b, place);
    if (foot.distance > 0.5 * lane.width) continue;
    const Found here{foot.distance,
                     {std::atan2(b.y() - a.y(), b.x() - a.x()), foot.offset, lane.one_way, s.lane}};
    const auto known = std::find_if(found.begin(), found.end(), [&](const Found& f) {
      return f.place.lane == here.place.lane;
    });
    if (known == found.end()) {
      found.push_back(here);
    } else if (here.distance < known->distance) {
      *known = here;  // keep the nearest segment of each lane
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Found& a, const Found& b) { return a.distance < b.distance; });
  std::vector<LanePlace> places;
  for (const Found& f : found) places.push_back(f.place);
  return places;
}

LaneMap LaneMap::fromFile(const std::string& path) {
  const CsvTable table = CsvTable::fromFile(path);
  const auto name = table.column("lane"), x = table.column("x"), y = table.column("y");
  const auto width = table.column("width"), one_way = table.column("one_way");
  std::vector<Lane> lanes;
  std::set<std::string> names;
  for (std::size_t r = 0; r < table.rows(); ++r) {
    const std::string lane_name(table.text(r, name));
    const bool fresh = lanes.empty() || lanes.back().name != lane_name;
    if (lane_name.empty()) table.fault(r, name, "the name of a lane");
    if (fresh) {
      if (!names.insert(lane_name).second)
        table.fault(r, name, "the points of a lane in consecutive lines");
      if (!lanes.empty() && lanes.back().points.size() < 2)
        table.fault(r, name, "a second point of lane '" + lanes.back().name + "'");
      lanes.push_back({lane_name, {}, table.real(r, width), table.flag(r, one_way)});
    }
    Lane& lane = lanes.back();
    if (table.real(r, width) <= 0 || table.real(r, width) > 100)
      table.fault(r, width, "a width of (0, 100] m");
    if (table.real(r, width) != lane.width) table.fault(r, width, "one width for the whole lane");
    if (table.flag(r, one_way) != lane.one_way)
      table.fault(r, one_way, "the same for the whole lane");
    const Vector2 p(table.real(r, x), table.real(r, y));
    for (const auto& [column, value] : {std::pair(x, p.x()), std::pair(y, p.y())}) {
      if (std::abs(value) > kFarthest) table.fault(r, column, "[m] at most 2e7");
    }
    if (!lane.points.empty() && (p - lane.points.back()).norm() > kLongestStep)
      table.fault(r, x, "a place within 1000 m of the one before");
    if (!lane.points.empty() && (p - lane.points.back()).norm() < kLeastStep)
      table.fault(r, x, "a place apart from the one before");
    lane.points.push_back(p);
  }
  if (!lanes.empty() && lanes.back().points.size() < 2)
    table.fault(table.rows() - 1, name, "a second point of lane '" + lanes.back().name + "'");
  return LaneMap(std::move(lanes));
}

std::string lanesText(const std::vector<Lane>& lanes) {
  std::string text = "lane,x,y,width,one_way\n";
  for (const Lane& lane : lanes) {
    for (const Vector2& p : lane.points) {
      text += fmt::format("{},{:.4f},{:.4f},{:.4f},{}\n", lane.name, p.x(), p.y(), lane.width,
                          lane.one_way ? 1 : 0);
    }
  }
  return text;
}

}  // namespace perception
