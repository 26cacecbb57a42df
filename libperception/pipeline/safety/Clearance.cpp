#include "libperception/pipeline/safety/Clearance.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/grid/way/NearCorridor.h"

namespace perception {
namespace {

constexpr double kSurface = 0.5;  // [m] along the corridor, as in denseReturns()
constexpr double kStrip = 0.25;   // [m] across it
constexpr double kRise = 0.1;     // [m] within these: roads rise by less (assumed)
// [m] Height of a car's underside, plus 2 cm by which the ground's model may be too low (assumed).
constexpr double kUnderside = 0.22;
// [m] above the road: lower returns are those of the road, and higher ones are hits (assumed).
constexpr double kRough = 0.05, kLow = 0.5;

/// A return in the corridor.
struct LowReturn {
  double s, height, weight;
  std::size_t strip;  ///< across the corridor
  std::uint32_t index;
  bool hit;
};

/// Heights [m] of the returns of a strip, within half a meter.
struct StripHeights {
  double lowest = kLow, highest = 0;
  double others = 0;  ///< returns that are no hits
};

/// The returns of one list that lie in a corridor.
class LowReturns {
 public:
  explicit LowReturns(const Corridor& corridor)
      : corridor_(corridor), T_ego_world_(corridor.T_world_ego.inverse()) {}

  void add(const GridPoints& points, const std::vector<float>& weights, bool hits) {
    const double half = corridor_.width / 2;
    for (const std::uint32_t i : nearCorridor(corridor_, corridor_.max, points)) {
      const Vector3 p = T_ego_world_ * points[i];
      const ArcPlace place = arcPlace(corridor_, p.x(), p.y());
      if (std::abs(place.d) > half || place.s < corridor_.from || place.s > corridor_.max) continue;
      const double height = p.z() - corridor_.roadAt(place.s);
      if (!hits && (height < kRough || height > kLow)) continue;
      const double weight = weights.empty() ? 1 : static_cast<double>(weights[i]);
      if (weight > 0)
        all_.push_back({place.s, height, weight,
                        static_cast<std::size_t>((place.d + half) / kStrip), i, hits});
      any_ = any_ || !hits;
    }
  }
  bool anyLow() const { return any_; }

  /// In the order in which the vehicle reaches them.
  const std::vector<LowReturn>& sorted() {
    std::sort(all_.begin(), all_.end(), [](const LowReturn& a, const LowReturn& b) {
      if (a.s != b.s) return a.s < b.s;
      return a.hit != b.hit ? a.hit : a.index < b.index;
    });
    return all_;
  }

 private:
  const Corridor& corridor_;
  Pose3 T_ego_world_;
  std::vector<LowReturn> all_;
  bool any_ = false;
};

/// Weight of those from `first` to `last` (not included) that are hits or stand up.
double standingWeight(const std::vector<LowReturn>& all, std::size_t first, std::size_t last,
                      std::vector<StripHeights>& strips) {
  std::fill(strips.begin(), strips.end(), StripHeights{});
  double sum = 0;
  for (std::size_t i = first; i < last; ++i) {
    StripHeights& strip = strips[all[i].strip];
    strip.lowest = std::min(strip.lowest, all[i].height);
    strip.highest = std::max(strip.highest, all[i].height);
    (all[i].hit ? sum : strip.others) += all[i].weight;
  }
  for (const StripHeights& strip : strips)
    if (strip.highest >= kUnderside && strip.highest - strip.lowest >= kRise) sum += strip.others;
  return sum;
}

}  // namespace

LowObstacle lowObstacle(const Corridor& corridor, const GridPoints& hits,
                        const std::vector<float>& weights, const GridPoints& others, double least) {
  LowObstacle found;
  found.free.distance = corridor.max;
  LowReturns returns(corridor);
  returns.add(others, {}, false);
  if (!returns.anyLow()) return found;
  returns.add(hits, weights, true);
  const std::vector<LowReturn>& all = returns.sorted();
  std::vector<StripHeights> strips(static_cast<std::size_t>(corridor.width / kStrip) + 1);
  for (std::size_t first = 0, last = 0; first < all.size(); ++first) {
    while (last < all.size() && all[last].s - all[first].s <= kSurface) ++last;
    if (static_cast<double>(last - first) < least) continue;
    const double sum = standingWeight(all, first, last, strips);
    if (sum < least) continue;
    found.free.distance = all[first].s;
    found.free.blocked = true;
    found.free.place = (all[first].hit ? hits : others)[all[first].index];
    found.returns = static_cast<std::size_t>(sum);
    break;
  }
  return found;
}

void clearOverhead(const SensorFrame& frame, const PlacedReturns& returns, double clearance,
                   double cell, GridScan& scan) {
  constexpr double kInto = 1.5;  // cells behind the return (assumed)
  const Vector3 sensor = frame.T_ego_sensor.translation();
  for (std::size_t i = 0; i < returns.size(); ++i) {
    if (static_cast<double>(returns.height[i]) < clearance) continue;
    const Vector3 p(static_cast<double>(returns.x[i]), static_cast<double>(returns.y[i]),
                    static_cast<double>(returns.z[i]));
    const double level = p.z() - frame.ground.a * p.x() - frame.ground.b * p.y() - frame.ground.c;
    if (level >= returns.height_max) continue;
    const Vector3 beyond = p + kInto * cell * (p - sensor).normalized();
    scan.clear.push_back(frame.ego.T_world_ego * beyond);
  }
}

}  // namespace perception
