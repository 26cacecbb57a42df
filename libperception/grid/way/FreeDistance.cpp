#include "libperception/grid/way/FreeDistance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "libperception/grid/way/NearCorridor.h"

namespace perception {
namespace {

constexpr double kStraight = 1e-6;  // [1/m] below it the arc is a line
constexpr double kTogether = 0.5;   // [m] along the arc: returns of one surface
constexpr double kGap = 1;          // [m] largest unknown gap between beams
constexpr double kChild = 1;        // [m] what stands as high on the way that is seen would be hit

// A column is known when one of two heights in it is, both below that of a child.
bool isKnown(const Corridor& corridor, double s,
             const std::function<double(const Vector3&)>& log_odds_at) {
  constexpr double kHeights[] = {0.5, kChild - 0.1};  // [m] cells of 0.2 m
  const Vector2 p = onArc(corridor, {s, 0});
  const double road = corridor.roadAt(s);
  return std::any_of(std::begin(kHeights), std::end(kHeights), [&](double z) {
    return log_odds_at(corridor.T_world_ego * Vector3(p.x(), p.y(), road + z)) != 0;
  });
}

/// A cell in the corridor.
struct CellInside {
  double s;
  std::size_t index;
};

/// The first of as many within half a meter; null: none.
const CellInside* firstTogether(std::vector<CellInside>& inside, std::size_t count) {
  std::sort(inside.begin(), inside.end(), [](const CellInside& a, const CellInside& b) {
    return a.s < b.s || (a.s == b.s && a.index < b.index);
  });
  for (std::size_t first = 0; first + count <= inside.size(); ++first)
    if (inside[first + count - 1].s - inside[first].s <= kTogether) return &inside[first];
  return nullptr;
}

}  // namespace

double Corridor::roadAt(double s) const {
  if (road.empty()) return 0;
  const double bounded = std::clamp(s, 0.0, static_cast<double>(road.size() - 1));
  const auto i = static_cast<std::size_t>(bounded);
  const auto low = static_cast<double>(road[i]);
  if (i + 1 == road.size()) return low;
  return low + (bounded - static_cast<double>(i)) * (static_cast<double>(road[i + 1]) - low);
}

ArcPlace arcPlace(const Corridor& corridor, double x, double y) {
  constexpr double kAnywhere = std::numeric_limits<double>::infinity();
  return arcPlaceWithin(corridor, x, y, kAnywhere).value_or(ArcPlace{});
}

Vector2 onArc(const Corridor& corridor, const ArcPlace& place) {
  const double k = corridor.curvature, sign = corridor.backward ? -1 : 1;
  if (std::abs(k) < kStraight) return sign * Vector2(place.s, place.d);
  const double radius = 1 / k - place.d;
  return sign * Vector2(radius * std::sin(k * place.s), 1 / k - radius * std::cos(k * place.s));
}

GridArea areaOf(const Corridor& corridor) {
  constexpr double kAround = 0.5,
                   kSlack = 1;  // [m] asked for; for slopes, and arcs between samples
  constexpr double kStep = 0.5, kTurn = 0.25;  // [m], [rad] from sample to sample
  const double side = corridor.width / 2 + kAround;
  GridArea area;
  std::swap(area.x_min, area.x_max), std::swap(area.y_min, area.y_max);
  const double bend = std::max(std::abs(corridor.curvature), kStraight);
  const double step = std::min(kStep, kTurn / bend);
  const double round = 2 * kPi / bend;  // [m] a whole circle
  const double begin = corridor.from - kAround;
  const double end = begin + std::min(corridor.max + kAround - begin, round);
  const auto samples = static_cast<int>(std::max(end - begin, 0.0) / step) + 1;
  for (int i = 0; i <= samples; ++i) {
    for (const double d : {-side, side}) {
      const Vector2 p = onArc(corridor, {begin + i * step, d});
      const Vector3 place = corridor.T_world_ego * Vector3(p.x(), p.y(), 0);
      area.x_min = std::min(area.x_min, place.x() - kSlack);
      area.x_max = std::max(area.x_max, place.x() + kSlack);
      area.y_min = std::min(area.y_min, place.y() - kSlack);
      area.y_max = std::max(area.y_max, place.y() + kSlack);
    }
  }
  return area;
}

FreeDistance freeDistance(const Corridor& corridor, const std::vector<GridCell>& occupied,
                          double step, const std::function<double(const Vector3&)>& log_odds_at) {
  FreeDistance result;
  result.distance = corridor.max;
  const Pose3 T_ego_world = corridor.T_world_ego.inverse();
  std::vector<CellInside> inside;
  for (std::size_t i = 0; i < occupied.size(); ++i) {
    const Vector3 p = T_ego_world * occupied[i].center;
    const double half = occupied[i].size.x() / 2;
    const auto place = arcPlaceWithin(corridor, p.x(), p.y(), corridor.width / 2 + half);
    if (!place || place->s + half < corridor.from || place->s - half > corridor.max) continue;
    inside.push_back({place->s - half, i});
  }
  if (const CellInside* first = firstTogether(inside, static_cast<std::size_t>(corridor.cells))) {
    result.distance = std::max(first->s, corridor.from);
    result.blocked = true;
    result.place = occupied[first->index].center;
  }
  result.seen = corridor.from;
  for (double s = corridor.from; s <= result.distance && s - result.seen <= kGap; s += step) {
    if (isKnown(corridor, s, log_odds_at)) result.seen = s;
  }
  return result;
}

double seenByBeams(const Corridor& corridor, double seen, const Vector3& from,
                   const std::vector<const GridPoints*>& ends, double height) {
  constexpr double kStep = 1;   // [m] along the arc: a bin is seen by one beam
  constexpr double kLow = 0.1;  // [m] above the road, whose height errs
  const auto bins = static_cast<std::size_t>(std::max(corridor.max - seen, 0.0) / kStep);
  if (bins == 0) return seen;
  const double highest = std::min(height, kChild);
  struct Bin {
    double x, y, range2;  // [m], [m^2] of its middle, from the sensor
    double road;          // [m] height
    bool seen = false;
  };
  const Pose3 T_ego_world = corridor.T_world_ego.inverse();
  const Vector3 sensor = T_ego_world * from;
  std::vector<Bin> way(bins);
  double least = std::numeric_limits<double>::infinity(), widest = 0;  // [m^2], [-] of all bins
  const Vector2 axis(corridor.backward ? -1 : 1, 0);
  for (std::size_t i = 0; i < bins; ++i) {
    const double s = seen + (static_cast<double>(i) + 0.5) * kStep;
    const Vector2 p = onArc(corridor, {s, 0}) - Vector2(sensor.head<2>());
    way[i] = {p.x(), p.y(), p.squaredNorm(), corridor.roadAt(s)};
    least = std::min(least, way[i].range2);
    if (p.dot(axis) <= 0) continue;
    widest = std::max(widest, (std::abs(p.y()) + corridor.width / 2) / p.dot(axis));
  }
  const auto slope = static_cast<float>(widest * axis.x());
  for (const GridPoints* points : ends) {
    const Eigen::Matrix3f turn = T_ego_world.linear().cast<float>();
    const Eigen::Vector3f base = (T_ego_world * points->base() - sensor).cast<float>();
    const float *px = points->x(0), *py = points->y(0), *pz = points->z(0);
    for (std::size_t k = 0; k < points->size(); ++k) {
      const float x = turn(0, 0) * px[k] + turn(0, 1) * py[k] + turn(0, 2) * pz[k] + base.x();
      const float y = turn(1, 0) * px[k] + turn(1, 1) * py[k] + turn(1, 2) * pz[k] + base.y();
      if (std::abs(y) > slope * x) continue;
      const Vector3 beam = T_ego_world * (*points)[k] - sensor;
      const double range2 = beam.head<2>().squaredNorm();
      if (range2 < least) continue;
      const double side = corridor.width / 2 * std::sqrt(range2);
      for (Bin& bin : way) {
        if (bin.seen || bin.range2 > range2) continue;
        if (std::abs(beam.x() * bin.y - beam.y() * bin.x) > side) continue;
        const double z = sensor.z() + beam.z() * std::sqrt(bin.range2 / range2) - bin.road;
        bin.seen = z > kLow && z < highest;
      }
    }
  }
  double last = seen;
  for (std::size_t i = 0; i < bins; ++i) {
    const double s = seen + (static_cast<double>(i) + 1) * kStep;
    if (s - last > kGap + kStep) break;
    if (way[i].seen) last = s;
  }
  return last;
}

}  // namespace perception
