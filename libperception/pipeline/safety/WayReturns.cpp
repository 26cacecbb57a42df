#include "libperception/pipeline/safety/WayReturns.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "libperception/grid/way/NearCorridor.h"

namespace perception {
namespace {

constexpr float kUnbounded = std::numeric_limits<float>::infinity();
constexpr double kRemembered = 0.45;  // [s] five scans at 10 Hz
constexpr double kBeside = 0.5;       // [m] to each side of the corridor, which may bend meanwhile
constexpr double kSurface = 0.5;      // [m] along the corridor: returns of one surface
constexpr double kMostStep = 1;       // [m] from scan to scan by which they lie farther apart
// A scan with more returns than so many times those of the newest one, and these: it has left.
constexpr std::size_t kMoreBefore = 3, kFewBefore = 6;
constexpr double kStrip = 0.25;  // [m] across it, and half a surface along it
constexpr float kRise = 0.1F;    // [m] within these: roads rise by less (assumed)
// [m] Height of a car's underside, plus 2 cm by which the ground's model may be too low (assumed).
constexpr float kUnderside = 0.22F;
// [m] above the road: lower returns are those of the road, and higher ones are hits (assumed).
constexpr double kRough = 0.05, kLow = 0.5;
// Vertical curves: radius [m] of the sharpest (method.md 8.1), acceleration [m/s^2] over one at the
// speed driven (assumed: thrice what roads are built for).
constexpr double kSharpest = 50, kLift = 1.5;

/// Heights of the returns in pieces of the corridor: strips across, half surfaces along it.
class RoughPieces {
 public:
  explicit RoughPieces(const Corridor& corridor)
      : half_(corridor.width / 2),
        strips_(static_cast<std::size_t>(corridor.width / kStrip) + 1),
        pieces_((static_cast<std::size_t>(corridor.max / kStrip) + 3) * strips_) {}

  std::size_t pieceOf(const ArcPlace& place) const {
    const auto strip = static_cast<std::size_t>((place.d + half_) / kStrip);
    return (static_cast<std::size_t>(place.s / kStrip) + 1) * strips_ + strip;
  }
  void add(std::size_t piece, float height) { pieces_[piece].add(height); }
  /// With the piece before it or the one behind it; the highest is `least` [m] high.
  bool standsUp(std::size_t piece, float least) const {
    return risesFrom(piece - strips_, least) || risesFrom(piece, least);
  }

 private:
  struct Heights {
    float lowest = kUnbounded, highest = -kUnbounded;  ///< [m]
    void add(float height) {
      lowest = std::min(lowest, height), highest = std::max(highest, height);
    }
  };
  bool risesFrom(std::size_t piece, float least) const {
    const Heights &a = pieces_[piece], &b = pieces_[piece + strips_];
    const float highest = std::max(a.highest, b.highest);
    return highest >= least && highest - std::min(a.lowest, b.lowest) >= kRise;
  }

  double half_;
  std::size_t strips_;
  std::vector<Heights> pieces_;
};

/// [m] by which the road may rise over `unseen` [m] behind its last place seen, `before` [m] above
/// the plane of the vehicle's wheels: on a circle of that radius [m], and by the slope to which one
/// on the way may have led.
double risesUnseen(double unseen, double before, double radius) {
  constexpr double kError = 0.03;  // [m] of heights seen (assumed)
  const double slope = std::sqrt(2 * (std::max(before, 0.0) + kError) / radius);
  return unseen * (unseen / (2 * radius) + slope);
}

}  // namespace

/// A return in the corridor.
struct WayReturns::Placed {
  ArcPlace at;
  const Return* of;
  std::size_t piece;
  bool newest;
  std::size_t scan;  ///< of the remembered ones
};

void WayReturns::add(Stamp stamp, Corridor corridor, const std::vector<float>& unseen,
                     const GridPoints& hits, const std::vector<float>& weights,
                     const GridPoints& others, const PhantomCauses& causes) {
  scans_.erase(std::remove_if(scans_.begin(), scans_.end(),
                              [&](const Scan& scan) { return stamp - scan.stamp > kRemembered; }),
               scans_.end());
  Scan scan{stamp, corridor.T_world_ego.translation(), {}};
  double radius = kSharpest;
  if (!scans_.empty()) {
    const double way = (scan.vehicle - scans_.back().vehicle).norm();
    step_ = std::min(way, kMostStep);
    const double speed = way / std::max(stamp - scans_.back().stamp, 1e-3);
    radius = std::max(radius, speed * speed / kLift);
  }
  corridor.width += 2 * kBeside;
  const Pose3 T_ego_world = corridor.T_world_ego.inverse();
  for (const GridPoints* points : {&hits, &others}) {
    const bool hit = points == &hits;
    if (!hit && causes.weather > 0) continue;  // none of them is sure
    for (const std::uint32_t i : nearCorridor(corridor, corridor.max, *points)) {
      const float weight = !hit || weights.empty() ? 1 : weights[i];
      if (weight <= 0) continue;
      const Vector3 place = (*points)[i], p = T_ego_world * place;
      const double s = alongArc(corridor, p.x(), p.y()), height = p.z() - corridor.roadAt(s);
      if (!hit && (height < kRough || height > kLow)) continue;
      const bool sure = causes.at(place.head<2>(), stamp).likelier() <= 0;
      const auto meter = static_cast<std::size_t>(std::max(s, 0.0));
      const double since = meter < unseen.size() ? static_cast<double>(unseen[meter]) : 0;
      const bool on_road =
          hit && since > 0 &&
          height < risesUnseen(since, corridor.roadAt(static_cast<double>(meter) - since), radius);
      if (hit || sure)
        scan.returns.push_back({place, static_cast<float>(height), weight, hit, sure, on_road});
    }
  }
  scans_.push_back(std::move(scan));
}

std::vector<WayReturns::Placed> WayReturns::placed(const Corridor& corridor, double recent) const {
  std::vector<Placed> all;
  const Pose3 T_ego_world = corridor.T_world_ego.inverse();
  const std::vector<Return>& now = scans_.back().returns;
  const bool asks = std::any_of(now.begin(), now.end(), [](const Return& r) { return r.on_road; });
  for (std::size_t k = 0; k < scans_.size(); ++k) {
    const Scan& scan = scans_[k];
    const bool newest = k + 1 == scans_.size();
    const double end = newest ? corridor.max : std::min(recent, corridor.max);
    for (const Return& r : scan.returns) {
      if (!newest && !r.sure && !asks) continue;  // they tell only what stands up
      const Vector3 p = T_ego_world * r.place;
      const auto at = arcPlaceWithin(corridor, p.x(), p.y(), corridor.width / 2);
      if (at && !(at->s < corridor.from || at->s > end)) all.push_back({*at, &r, 0, newest, k});
    }
  }
  return all;
}

// What stands shows about as many returns in each scan, and ever more as the vehicle comes nearer.
// Of what has left, such as a vehicle ahead, the scans before have many more at the place.
std::vector<char> WayReturns::whatHasLeft(const std::vector<Placed>& all) const {
  std::vector<char> left(all.size());
  std::vector<std::size_t> returns(scans_.size());
  std::size_t first = 0, end = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    while (end < all.size() && all[end].at.s - all[i].at.s <= kSurface) ++returns[all[end++].scan];
    while (all[i].at.s - all[first].at.s > kSurface) --returns[all[first++].scan];
    const std::size_t most = kMoreBefore * returns.back() + kFewBefore;
    left[i] = *std::max_element(returns.begin(), returns.end()) > most;
  }
  return left;
}

// A beam passes along a level surface by as much as the vehicle drives between two scans.
WayReturns::Found WayReturns::chained(const std::vector<Placed>& all, double least) const {
  const std::vector<char> left = whatHasLeft(all);
  Found found;
  double sum = 0;
  const Placed* last = nullptr;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Placed& r = all[i];
    if (!r.of->sure || left[i]) continue;
    const double apart = last ? r.at.s - last->at.s : 0;
    const bool one_scan = last && last->newest && r.newest;
    if (apart > kSurface + (one_scan ? 0 : step_)) found = {}, sum = 0;
    last = &r;
    ++found.returns, sum += static_cast<double>(r.of->weight);
    if (found.at == nullptr && r.newest) found.at = &r;
    if (sum >= least && found.at != nullptr) return found;
  }
  return {};
}

WayReturns::Found WayReturns::together(const std::vector<Placed>& all, double least) {
  std::vector<const Placed*> hits;
  for (const Placed& r : all)
    if (r.newest && r.of->hit) hits.push_back(&r);
  double sum = 0;
  for (std::size_t first = 0, i = 0; i < hits.size(); ++i) {
    while (hits[i]->at.s - hits[first]->at.s > kSurface) sum -= hits[first++]->of->weight;
    sum += hits[i]->of->weight;
    if (sum >= least) return {hits[first], i + 1 - first};
  }
  return {};
}

void WayReturns::keepWhatStandsUp(const Corridor& corridor, std::vector<Placed>& all) {
  RoughPieces low(corridor), hits(corridor);
  for (Placed& r : all) {
    r.piece = low.pieceOf(r.at);
    // Higher ones say nothing of the road: a bonnet, of which each scan hits a spot.
    if (r.of->height <= static_cast<float>(kLow)) low.add(r.piece, r.of->height);
    if (r.of->hit) hits.add(r.piece, static_cast<float>(r.of->place.z()));
  }
  const auto lies = [&](const Placed& r) {
    if (r.of->hit) return r.of->on_road && !hits.standsUp(r.piece, -kUnbounded);
    return !low.standsUp(r.piece, kUnderside);
  };
  all.erase(std::remove_if(all.begin(), all.end(), lies), all.end());
}

ReturnObstacle WayReturns::nearest(const Corridor& corridor, double recent, double least) const {
  ReturnObstacle found;
  found.free.distance = corridor.max;
  if (scans_.empty()) return found;
  std::vector<Placed> all = placed(corridor, recent);
  if (std::any_of(all.begin(), all.end(),
                  [](const Placed& r) { return !r.of->hit || r.of->on_road; }))
    keepWhatStandsUp(corridor, all);
  std::stable_sort(all.begin(), all.end(),
                   [](const Placed& a, const Placed& b) { return a.at.s < b.at.s; });
  const Found chain = chained(all, least), window = together(all, least);
  const bool by_chain = chain.at && !(window.at && window.at->at.s < chain.at->at.s);
  const Found& nearer = by_chain ? chain : window;
  if (!nearer.at) return found;
  found.free.distance = nearer.at->at.s;
  found.free.blocked = true;
  found.free.place = nearer.at->of->place;
  found.returns = nearer.returns;
  return found;
}

}  // namespace perception
