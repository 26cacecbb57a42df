#include "libperception/simulation/world/GroundAppearance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "libperception/simulation/world/Scenario.h"
#include "libperception/simulation/world/Texture.h"

namespace perception {
namespace {

constexpr double kLine = 0.14;                   // [m] width of a marking
constexpr double kDash = 3, kGap = 3;            // [m] of a center line in town
constexpr double kTwoLanes = 5;                  // [m] a road as wide has a center line
constexpr double kKeepOff = 2;                   // [m] between markings and a road that crosses
constexpr double kCurb = 0.15, kPavement = 2.4;  // [m] beside the asphalt
constexpr double kTile = 0.5;                    // [m] of the sidewalk
const Rgb kWhite(0.62, 0.62, 0.58);

/// A place beside a line of two or more points.
struct Offset {
  double along = 0;                                         ///< [m] from its start
  double across = std::numeric_limits<double>::infinity();  ///< [m] > 0 to the left
};

Offset offsetFrom(const std::vector<Vector2>& line, const Vector2& p) {
  Offset best;
  double start = 0, nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Vector2 ab = line[i + 1] - line[i], ap = p - line[i];
    const double length = ab.norm();
    if (!(length > 0)) continue;
    const double s = std::clamp(ap.dot(ab) / length, 0.0, length);
    const double distance = (ap - s / length * ab).norm();
    if (distance < nearest) {
      nearest = distance;
      const double side = ab.x() * ap.y() - ab.y() * ap.x() < 0 ? -1 : 1;
      best = {start + s, side * distance};
    }
    start += length;
  }
  return best;
}

// Share of the pixel that a line `off` [m] away covers.
double covered(double off, double pixel) {
  const double wide = std::max(pixel, 0.01);
  return std::clamp((.5 * kLine - std::abs(off)) / wide + .5, 0.0, 1.0) *
         std::min(1.0, kLine / wide);
}

bool inDash(double along) {
  return along - (kDash + kGap) * std::floor(along / (kDash + kGap)) < kDash;
}

// Weight of a pattern of that size [m]: 1 if resolved, 0 if a pixel covers it.
double groundDetail(double size, double pixel) {
  return std::clamp(2 - 2 * pixel / size, 0.0, 1.0);
}

Rgb asphalt(const Vector2& p, double pixel) {
  const double patches = smoothValue(p.x() / 6, p.y() / 6, 1) - .5;
  const double grain = smoothValue(p.x() / .05, p.y() / .05, 2) - .5;
  return Rgb(.095, .095, .10) * (1 + .25 * patches + .15 * groundDetail(.05, pixel) * grain);
}

Rgb pavement(const Vector2& p, double pixel) {
  const double i = std::floor(p.x() / kTile), j = std::floor(p.y() / kTile);
  const double tile = cellValue(static_cast<std::int64_t>(i), static_cast<std::int64_t>(j), 3) - .5;
  const double u = p.x() / kTile - i, v = p.y() / kTile - j;
  const bool seam = std::min(u, v) < .06;
  const double seen = groundDetail(kTile, pixel);
  return Rgb(.30, .29, .27) * (1 + seen * (.15 * tile - (seam ? .3 : 0)));
}

Rgb grass(const Vector2& p, double pixel) {
  const double patches = smoothValue(p.x() / 3, p.y() / 3, 4) - .5;
  const double blades = smoothValue(p.x() / .2, p.y() / .2, 5) - .5;
  return Rgb(.10, .17, .05) * (1 + .5 * patches + .5 * groundDetail(.2, pixel) * blades);
}

}  // namespace

GroundAppearance::GroundAppearance(const Scenario& scenario) : lanes_(scenario.lanes) {
  for (const RoadParams& road : scenario.roads) {
    Lane line{road.name, {}, road.width, false};
    for (std::size_t i = 0; i < road.x.size(); ++i) line.points.emplace_back(road.x[i], road.y[i]);
    roads_.push_back(std::move(line));
  }
}

Rgb GroundAppearance::reflectance(const Vector2& place, double pixel) const {
  double beyond = -1;  // [m] off the asphalt; without roads it is everywhere
  if (!roads_.empty()) {
    beyond = std::numeric_limits<double>::infinity();
    for (const Lane& road : roads_) {
      beyond = std::min(beyond, std::abs(offsetFrom(road.points, place).across) - .5 * road.width);
    }
  }
  if (beyond > kPavement) return grass(place, pixel);
  if (beyond > kCurb) return pavement(place, pixel);
  if (beyond > 0) return {.40, .39, .37};
  const double marked = roads_.empty() ? markedByLanes(place, pixel) : markedByRoads(place, pixel);
  return (1 - marked) * asphalt(place, pixel) + marked * kWhite;
}

// Edge lines and a dashed center line, none where another road crosses.
double GroundAppearance::markedByRoads(const Vector2& place, double pixel) const {
  double marked = 0;
  for (const Lane& road : roads_) {
    const Offset at = offsetFrom(road.points, place);
    if (std::abs(at.across) > .5 * road.width) continue;
    const bool crossed = std::any_of(roads_.begin(), roads_.end(), [&](const Lane& other) {
      return &other != &road &&
             std::abs(offsetFrom(other.points, place).across) < .5 * other.width + kKeepOff;
    });
    if (crossed) continue;
    marked = std::max(marked, covered(std::abs(at.across) - (.5 * road.width - 2 * kLine), pixel));
    if (road.width >= kTwoLanes && inDash(at.along)) {
      marked = std::max(marked, covered(at.across, pixel));
    }
  }
  return marked;
}

// Lane borders: dashed between two lanes, none inside another lane.
double GroundAppearance::markedByLanes(const Vector2& place, double pixel) const {
  double marked = 0;
  for (const Lane& lane : lanes_) {
    const Offset at = offsetFrom(lane.points, place);
    const double off = std::abs(at.across) - .5 * lane.width;
    if (std::abs(off) > kLine + pixel) continue;
    bool inside = false, beside = false;
    for (const Lane& other : lanes_) {
      if (&other == &lane) continue;
      const double within = .5 * other.width - std::abs(offsetFrom(other.points, place).across);
      inside = inside || within > 2 * kLine;
      beside = beside || within > -2 * kLine;
    }
    if (inside || (beside && !inDash(at.along))) continue;
    marked = std::max(marked, covered(off, pixel));
  }
  return marked;
}

}  // namespace perception
