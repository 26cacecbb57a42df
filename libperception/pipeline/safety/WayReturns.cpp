#include "libperception/pipeline/safety/WayReturns.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "libperception/grid/way/NearCorridor.h"

namespace perception {
namespace {

constexpr double kRemembered = 0.45;  // [s] five scans at 10 Hz
constexpr double kBeside = 0.5;       // [m] to each side of the corridor, which may bend meanwhile
constexpr double kSurface = 0.5;      // [m] along the corridor: returns of one surface
constexpr double kStrip = 0.25;       // [m] across it, and half a surface along it
constexpr float kRise = 0.1F;         // [m] within these: roads rise by less (assumed)
// [m] Height of a car's underside, plus 2 cm by which the ground's model may be too low (assumed).
constexpr float kUnderside = 0.22F;
// [m] above the road: lower returns are those of the road, and higher ones are hits (assumed).
constexpr double kRough = 0.05, kLow = 0.5;

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
  /// With the piece before it or the one behind it.
  bool standsUp(std::size_t piece) const { return risesFrom(piece - strips_) || risesFrom(piece); }

 private:
  struct Heights {
    float lowest = static_cast<float>(kLow), highest = 0;  ///< [m]
    void add(float height) {
      lowest = std::min(lowest, height), highest = std::max(highest, height);
    }
  };
  bool risesFrom(std::size_t piece) const {
    const Heights &a = pieces_[piece], &b = pieces_[piece + strips_];
    const float highest = std::max(a.highest, b.highest);
    return highest >= kUnderside && highest - std::min(a.lowest, b.lowest) >= kRise;
  }

  double half_;
  std::size_t strips_;
  std::vector<Heights> pieces_;
};

}  // namespace

/// A return in the corridor.
struct WayReturns::Placed {
  ArcPlace at;
  const Return* of;
  std::size_t piece;
  bool newest;
};

void WayReturns::add(Stamp stamp, Corridor corridor, const GridPoints& hits,
                     const std::vector<float>& weights, const GridPoints& others,
                     const PhantomCauses& causes) {
  scans_.erase(std::remove_if(scans_.begin(), scans_.end(),
                              [&](const Scan& scan) { return stamp - scan.stamp > kRemembered; }),
               scans_.end());
  Scan scan{stamp, {}};
  corridor.width += 2 * kBeside;
  const Pose3 T_ego_world = corridor.T_world_ego.inverse();
  for (const GridPoints* points : {&hits, &others}) {
    const bool hit = points == &hits;
    if (!hit && causes.weather > 0) continue;  // none of them is sure
    for (const std::uint32_t i : nearCorridor(corridor, corridor.max, *points)) {
      const float weight = !hit || weights.empty() ? 1 : weights[i];
      if (weight <= 0) continue;
      const Vector3 place = (*points)[i], p = T_ego_world * place;
      const double height = p.z() - corridor.roadAt(arcPlace(corridor, p.x(), p.y()).s);
      if (!hit && (height < kRough || height > kLow)) continue;
      const bool sure = causes.at(place.head<2>(), stamp).likelier() <= 0;
      if (hit || sure)
        scan.returns.push_back({place, static_cast<float>(height), weight, hit, sure});
    }
  }
  scans_.push_back(std::move(scan));
}

std::vector<WayReturns::Placed> WayReturns::placed(const Corridor& corridor, double recent) const {
  std::vector<Placed> all;
  const Pose3 T_ego_world = corridor.T_world_ego.inverse();
  for (const Scan& scan : scans_) {
    const bool newest = &scan == &scans_.back();
    const double end = newest ? corridor.max : std::min(recent, corridor.max);
    for (const Return& r : scan.returns) {
      if (!newest && !r.sure) continue;
      const Vector3 p = T_ego_world * r.place;
      const ArcPlace at = arcPlace(corridor, p.x(), p.y());
      if (std::abs(at.d) > corridor.width / 2 || at.s < corridor.from || at.s > end) continue;
      all.push_back({at, &r, 0, newest});
    }
  }
  return all;
}

WayReturns::Found WayReturns::chained(const std::vector<Placed>& all, double least) {
  Found found;
  double sum = 0, last = 0;
  for (const Placed& r : all) {
    if (!r.of->sure) continue;
    if (found.returns > 0 && r.at.s - last > kSurface) found = {}, sum = 0;
    last = r.at.s;
    ++found.returns, sum += r.of->weight;
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

ReturnObstacle WayReturns::nearest(const Corridor& corridor, double recent, double least) const {
  ReturnObstacle found;
  found.free.distance = corridor.max;
  if (scans_.empty()) return found;
  std::vector<Placed> all = placed(corridor, recent);
  if (std::any_of(all.begin(), all.end(), [](const Placed& r) { return !r.of->hit; })) {
    RoughPieces pieces(corridor);
    for (Placed& r : all) {
      r.piece = pieces.pieceOf(r.at);
      // Higher ones say nothing of the road: a bonnet, of which each scan hits a spot.
      if (r.of->height <= static_cast<float>(kLow)) pieces.add(r.piece, r.of->height);
    }
    const auto lies = [&](const Placed& r) { return !r.of->hit && !pieces.standsUp(r.piece); };
    all.erase(std::remove_if(all.begin(), all.end(), lies), all.end());
  }
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
