#include "libperception/lidar/segments/GrazedSurfaces.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "libperception/core/math/Angle.h"
#include "libperception/lidar/linkage/Forest.h"
#include "libperception/measurement/models/FootprintInView.h"

namespace perception {
namespace {

// All assumed.
constexpr double kLeastGap = 0.3, kMostGap = 1.6;  ///< between columns, in steps of azimuth
constexpr double kMostDistance = 1.2;  ///< [m] of columns: the space between parked cars parts them
constexpr double kLeastOverlap = 0.4;  ///< of the higher one's height: a hood beside a cabin
constexpr double kLeastReach = 0.2, kMostReach = 1.3;    ///< [m] to the third column
constexpr double kOffLine = 0.05, kOffLineSlope = 0.05;  ///< [m], [m/m] of the third column
constexpr double kEdge = 0.35, kSecond = 1.35;  ///< in steps: ends of the first and second column

/// What is behind and above a hood or a boot: a cabin or a roof.
struct StepLimits {
  /// Share of its returns that may lie lower: a little of a car's side is seen past its hood.
  double side_share = 0.2;
  float lowest = 0.6f;      ///< [m] above the ground, of its lowest return but those
  float thickness = 1.2f;   ///< [m] at most
  float flat = 0.3f;        ///< [m] thickness of a roof, which may be narrow
  double width = 1;         ///< [m] least one of a cabin: a person behind a hood is narrower
  double body_width = 0.8;  ///< [m] least one of what is before it
  float below = 0.3f, above = 0.7f;  ///< [m] of its lowest return from the highest before it
  double behind = 2;                 ///< [m] at most
  double covered = 0.7;              ///< least share of its azimuths with the body before it
};
constexpr StepLimits kStep;

/// Columns of a group at one end.
struct End {
  Vector2 edge = Vector2::Zero();  ///< [m] mean of the outermost column
  std::optional<Vector2> inner;    ///< [m] mean of the one beside it
};

/// About the places of returns [m].
struct PlaceBox {
  Vector2 low = Vector2::Constant(std::numeric_limits<double>::infinity()), high = -low;
  void add(const Vector2& p) { low = low.cwiseMin(p), high = high.cwiseMax(p); }
  /// Not above that of any return in it, rounding included.
  double squaredDistance(const PlaceBox& b) const {
    return (low - b.high).cwiseMax(b.low - high).cwiseMax(0.0).squaredNorm();
  }
};

struct Columns {
  PlaceBox box;
  double low = 0, high = 0;   ///< [rad] azimuth; low in [0, 2 pi)
  float bottom = 0, top = 0;  ///< [m] above the ground
  double nearest = 0;         ///< [m] horizontal distance of the nearest return from the sensor
  End at_low, at_high;
};

/// Mean position of returns.
struct Mean {
  Vector2 sum = Vector2::Zero();
  int count = 0;
  void add(const Vector2& p) { sum += p, ++count; }
  std::optional<Vector2> value() const {
    return count > 0 ? std::optional<Vector2>(sum / count) : std::nullopt;
  }
};

class SurfaceFinder {
 public:
  SurfaceFinder(const ReturnPlaces& places, const std::vector<ReturnGroup>& groups,
                const Vector3& sensor, const ReturnDirections& directions, double step)
      : places_(places),
        groups_(groups),
        sensor_(sensor),
        azimuth_(directions.azimuth),
        step_(step) {}

  std::vector<std::vector<std::uint32_t>> find() {
    columns_.reserve(groups_.size());
    for (const ReturnGroup& group : groups_) columns_.push_back(columnsOf(group));
    findBodies();
    after_.resize(groups_.size()), before_.resize(groups_.size());
    if (step_ > 0) findNeighbors();
    Forest surfaces(groups_.size());
    for (std::uint32_t a = 0; a < groups_.size(); ++a)
      for (const std::uint32_t b : after_[a])
        if (onOneLine(a, b)) surfaces.unite(a, b);
    for (std::uint32_t upper = 0; upper < groups_.size(); ++upper)
      if (const auto body = bodyBelow(upper)) surfaces.unite(*body, upper);
    std::vector<std::vector<std::uint32_t>> members(groups_.size()), joined;
    for (std::uint32_t g = 0; g < groups_.size(); ++g) members[surfaces.find(g)].push_back(g);
    for (auto& set : members)
      if (set.size() > 1) joined.push_back(std::move(set));
    return joined;
  }

 private:
  Vector2 placeOf(std::uint32_t i) const { return {places_.x[i], places_.y[i]}; }

  Columns columnsOf(const ReturnGroup& group) const {
    constexpr float kFar = std::numeric_limits<float>::infinity();
    float x0 = kFar, x1 = -kFar, y0 = kFar, y1 = -kFar, bottom = kFar, top = -kFar, least = kFar,
          most = -kFar;
    double nearest2 = std::numeric_limits<double>::infinity();
    for (const std::uint32_t i : group) {
      const float x = places_.x[i], y = places_.y[i], height = places_.height[i];
      x0 = std::min(x0, x), x1 = std::max(x1, x), y0 = std::min(y0, y), y1 = std::max(y1, y);
      bottom = std::min(bottom, height), top = std::max(top, height);
      least = std::min(least, azimuth_[i]), most = std::max(most, azimuth_[i]);
      nearest2 = std::min(nearest2, (placeOf(i) - sensor_.head<2>()).squaredNorm());
    }
    Columns columns;
    columns.box.add({x0, y0}), columns.box.add({x1, y1});
    columns.bottom = bottom, columns.top = top, columns.nearest = std::sqrt(nearest2);
    const auto first = static_cast<double>(azimuth_[group.front()]);
    const auto azimuthOf = [&](std::uint32_t i) {  // without a jump at +-pi
      const double off = static_cast<double>(azimuth_[i]) - first;
      return first + (std::abs(off) < kPi ? off : off - std::copysign(kTwoPi, off));
    };
    auto low = static_cast<double>(least), high = static_cast<double>(most);
    // Away from zero the above is exact, and within half a circle it is the float itself.
    constexpr float kExact = 1e-6f;
    const bool same = (least > kExact || most < -kExact) && high - low < kPi;
    if (!same) low = high = first;
    for (std::size_t k = 0; !same && k < group.size(); ++k)
      low = std::min(low, azimuthOf(group[k])), high = std::max(high, azimuthOf(group[k]));
    const float beside = same ? static_cast<float>(kSecond * step_) + 1e-5f : kFar;
    Mean at_low, beside_low, at_high, beside_high;
    for (const std::uint32_t i : group) {
      if (azimuth_[i] > least + beside && azimuth_[i] < most - beside) continue;
      const double azimuth = azimuthOf(i), from_low = azimuth - low, from_high = high - azimuth;
      const Vector2 place = placeOf(i);
      if (from_low <= kEdge * step_) {
        at_low.add(place);
      } else if (from_low < kSecond * step_) {
        beside_low.add(place);
      }
      if (from_high <= kEdge * step_) {
        at_high.add(place);
      } else if (from_high < kSecond * step_) {
        beside_high.add(place);
      }
    }
    columns.at_low = {*at_low.value(), beside_low.value()};
    columns.at_high = {*at_high.value(), beside_high.value()};
    const double turn = low < 0 ? kTwoPi : 0;
    columns.low = low + turn, columns.high = high + turn;
    return columns;
  }

  /// Most returns of a cabin or a roof are higher [m above the ground]; 0: it is neither.
  float mostlyAbove(const ReturnGroup& group, float top) const {
    const auto side =
        static_cast<std::ptrdiff_t>(kStep.side_share * static_cast<double>(group.size()));
    const auto low = std::count_if(group.begin(), group.end(), [&](std::uint32_t i) {
      return places_.height[i] < kStep.lowest || top - places_.height[i] > kStep.thickness;
    });
    if (low > side) return 0;
    std::vector<float> heights(group.size());
    for (std::size_t k = 0; k < group.size(); ++k) heights[k] = places_.height[group[k]];
    std::nth_element(heights.begin(), heights.begin() + side, heights.end());
    return heights[static_cast<std::size_t>(side)];
  }

  /// Pairs with no room for a column between them.
  void findNeighbors() {
    std::vector<std::pair<double, std::uint32_t>> starts;
    for (std::uint32_t g = 0; g < columns_.size(); ++g)
      for (const double turn : {0.0, kTwoPi}) starts.emplace_back(columns_[g].low + turn, g);
    std::sort(starts.begin(), starts.end());
    for (std::uint32_t a = 0; a < columns_.size(); ++a) {
      const double from = columns_[a].high + kLeastGap * step_,
                   to = columns_[a].high + kMostGap * step_;
      for (auto s = std::lower_bound(starts.begin(), starts.end(), std::make_pair(from, 0u));
           s != starts.end() && s->first <= to; ++s) {
        const std::uint32_t b = s->second;
        if (a == b || !mayTouch(columns_[a], columns_[b])) continue;
        after_[a].push_back(b), before_[b].push_back(a);
      }
    }
  }

  static bool mayTouch(const Columns& a, const Columns& b) {
    if ((a.at_high.edge - b.at_low.edge).norm() > kMostDistance) return false;
    const float overlap = std::min(a.top, b.top) - std::max(a.bottom, b.bottom);
    const float higher = std::max(a.top - a.bottom, b.top - b.bottom);
    return overlap > 0 &&
           static_cast<double>(overlap) >= kLeastOverlap * static_cast<double>(higher);
  }

  /// Whether some third column, within either or beyond it, continues the line from a to b.
  bool onOneLine(std::uint32_t a, std::uint32_t b) const {
    const End &from = columns_[a].at_high, &to = columns_[b].at_low;
    if (from.inner ? continues(to.edge, from.edge, *from.inner) : anyBefore(a, to.edge))
      return true;
    return to.inner ? continues(from.edge, to.edge, *to.inner) : anyAfter(b, from.edge);
  }

  bool anyBefore(std::uint32_t a, const Vector2& far) const {
    return std::any_of(before_[a].begin(), before_[a].end(), [&](std::uint32_t c) {
      return continues(far, columns_[a].at_high.edge, columns_[c].at_high.edge);
    });
  }
  bool anyAfter(std::uint32_t b, const Vector2& far) const {
    return std::any_of(after_[b].begin(), after_[b].end(), [&](std::uint32_t c) {
      return continues(far, columns_[b].at_low.edge, columns_[c].at_low.edge);
    });
  }

  /// Whether `third` lies on the line from `first` through `second`, beyond it.
  static bool continues(const Vector2& first, const Vector2& second, const Vector2& third) {
    const Vector2 along = (second - first).normalized(), on = third - second;
    const double reach = on.dot(along), off = std::abs(on.dot(perpendicular(along)));
    return reach >= kLeastReach && reach <= kMostReach && off <= kOffLine + kOffLineSlope * reach;
  }

  /// Groups wide enough for what is before a cabin, by their highest return.
  void findBodies() {
    for (std::uint32_t g = 0; g < columns_.size(); ++g)
      if (widthOf(columns_[g]) >= kStep.body_width) bodies_.emplace_back(columns_[g].top, g);
    std::sort(bodies_.begin(), bodies_.end());
  }

  /// The nearest group before and below a cabin or a roof.
  std::optional<std::uint32_t> bodyBelow(std::uint32_t upper) const {
    const Columns& u = columns_[upper];
    if (u.top < kStep.lowest) return std::nullopt;
    const float bottom = mostlyAbove(groups_[upper], u.top);
    if (bottom < kStep.lowest) return std::nullopt;
    if (u.top - bottom > kStep.flat && widthOf(u) < kStep.width) return std::nullopt;
    std::vector<std::uint32_t> below;
    constexpr float kRounding = 1e-3f;  // [m]
    for (auto body = std::lower_bound(bodies_.begin(), bodies_.end(),
                                      std::make_pair(bottom - kStep.above - kRounding, 0u));
         body != bodies_.end() && body->first <= bottom + kStep.below + kRounding; ++body) {
      const auto [top, b] = *body;
      if (b != upper && bottom >= top - kStep.below && bottom <= top + kStep.above &&
          columns_[b].nearest <= u.nearest && covers(columns_[b], u))
        below.push_back(b);
    }
    std::sort(below.begin(), below.end());  // of equally near ones, the first
    std::optional<std::uint32_t> body;
    double least = kStep.behind;
    for (const std::uint32_t b : below) {
      const double distance = distanceOf(b, upper, least);
      if (distance < least) least = distance, body = b;
    }
    return body;
  }

  static double widthOf(const Columns& c) { return (c.high - c.low) * c.nearest; }

  /// Whether the azimuths of `body` cover most of those of `roof`.
  static bool covers(const Columns& body, const Columns& roof) {
    const double shift = kTwoPi * std::round((body.low - roof.low) / kTwoPi);
    const double covered =
        std::min(roof.high, body.high - shift) - std::max(roof.low, body.low - shift);
    return covered >= kStep.covered * (roof.high - roof.low);
  }

  /// Horizontal distance of the nearest returns of two groups [m]; at most `within`.
  double distanceOf(std::uint32_t a, std::uint32_t b, double within) const {
    double least = within * within;
    if (columns_[a].box.squaredDistance(columns_[b].box) >= least) return within;
    std::vector<Vector2> facing;
    for (const std::uint32_t j : groups_[a])
      if (const Vector2 p = placeOf(j); columns_[b].box.squaredDistance({p, p}) < least)
        facing.push_back(p);
    for (const std::uint32_t i : groups_[b])
      if (const Vector2 p = placeOf(i); columns_[a].box.squaredDistance({p, p}) < least)
        for (const Vector2& other : facing) least = std::min(least, (p - other).squaredNorm());
    return std::sqrt(least);
  }

  const ReturnPlaces& places_;
  const std::vector<ReturnGroup>& groups_;
  const Vector3& sensor_;
  const RawVector<float>& azimuth_;
  const double step_;  ///< [rad] 0: not known
  std::vector<Columns> columns_;
  std::vector<std::pair<float, std::uint32_t>> bodies_;     ///< [m] top; group
  std::vector<std::vector<std::uint32_t>> after_, before_;  ///< neighbors by azimuth
};

}  // namespace

std::vector<std::vector<std::uint32_t>> grazedSurfaces(const ReturnPlaces& places,
                                                       const std::vector<ReturnGroup>& groups,
                                                       const Vector3& sensor,
                                                       const ReturnDirections& directions,
                                                       double step) {
  return SurfaceFinder(places, groups, sensor, directions, step).find();
}

}  // namespace perception
