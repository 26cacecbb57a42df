#include "libperception/filter/likelihood/PhantomOdds.h"

#include <algorithm>
#include <cmath>

#include "libperception/filter/state/ClassFilterMotion.h"

namespace perception {
namespace {

// All assumed.
constexpr double kSure = 0.999;  // P(phantom), at most
constexpr double kLate = 0.35;   // [s] for which a wake counts as just known
constexpr double kLeastDetection = 0.1;
constexpr double kDrift = 3, kDriftSpread = 1;  // [m/s] of spray, by the wind

Vector2 placeOf(const Track& track) {
  return track.bank[track.filterOf(static_cast<std::size_t>(track.likeliestClass()))].x.head<2>();
}

/// Outside of wakes a cloud fades from its first detection on, as of an unknown vehicle's.
double phantomDetection(const Track& track, const MeasurementScan& scan) {
  const Stamp now = scan.state.stamp;
  const auto age = scan.wakes ? scan.wakes->age(placeOf(track), now) : std::nullopt;
  return WakeMap::detection(scan.modality, age ? *age : now - track.birth);
}

/// Likelihood of the speed of a phantom, 1 up to that of the wind.
double drifts(const Track& track, const FilterModel& model) {
  const ClassId best = track.likeliestClass();
  const ClassFilter& f = track.bank[track.filterOf(static_cast<std::size_t>(best))];
  if (!model.classes[best].motion->moves) return 1;
  const Kinematics k = kinematicsOf(model.classes[best], f);
  const Vector2 v = k.q.segment<2>(2);
  const double excess = v.norm() - kDrift;
  if (excess <= 0) return 1;
  const Vector2 u = v.normalized();
  const Matrix4 J = k.J.topRows<4>();
  const Matrix2 P = (J * f.P * J.transpose()).bottomRightCorner<2, 2>();
  return std::exp(-0.5 * excess * excess / (kDriftSpread * kDriftSpread + u.dot(P * u)));
}

/// P(phantom) after Bayes' rule.
double weighed(double before, double as_phantom, double as_object) {
  const double phantom = before * as_phantom, object = (1 - before) * as_object;
  return phantom + object > 0 ? phantom / (phantom + object) : before;
}

/// Whether a lidar's track stands where a vehicle came by, as was not known when it was born, but
/// is since a moment ago.
bool isInLateWake(const Track& track, const MeasurementScan& scan) {
  if (!scan.wakes || scan.wakes->density <= 0 || scan.modality != Modality::kLidar) return false;
  const Stamp now = scan.state.stamp;
  const Vector2 place = placeOf(track);
  if (!scan.wakes->cameBy(place, now)) return false;
  for (const Stamp then : {track.birth, now + -kLate})
    if (scan.wakes->age(place, then) || scan.wakes->cameBy(place, then)) return false;
  return true;
}

/// P(phantom) of a track whose wake is known only now: of a newborn there that was seen as often.
double lateDoubt(double newborn, double seen, double detection, const Track& track) {
  const int hits = track.hits[modalityIndex(Modality::kLidar)] - 1;  // without that of this scan
  const double again = std::pow(seen / std::max(detection, kLeastDetection), std::max(0, hits - 1));
  return weighed(newborn, again, 1);
}

}  // namespace

double phantomDensity(const Vector2& place, const MeasurementScan& scan) {
  if (!scan.wakes || scan.wakes->density <= 0) return 0;
  const WakeMap::Past past = scan.wakes->pastOf(place, scan.state.stamp);
  return past.came_by || scan.wakes->age(place, scan.state.stamp) ? scan.wakes->density : 0;
}

double detectionWithPhantom(const Track& track, const MeasurementScan& scan, double detection) {
  return (1 - track.phantom) * detection + track.phantom * phantomDetection(track, scan);
}

double phantomOdds(const Measurement& m) {
  return m.phantom ? m.phantom->probability / (1 - std::min(m.phantom->probability, kSure)) : 0;
}

void phantomHit(const Measurement& m, double shape, double newborn, const MeasurementScan& scan,
                double detection, const FilterModel& model, Track& track) {
  if (newborn > track.phantom && isInLateWake(track, scan)) {
    track.phantom = std::max(
        track.phantom,
        lateDoubt(newborn, phantomDetection(track, scan) * drifts(track, model), detection, track));
  }
  if (track.phantom <= 0) return;
  const double seen = phantomDetection(track, scan) * drifts(track, model);
  const double without = weighed(track.phantom, seen, detection);
  const double with = weighed(track.phantom, std::exp(shape) * seen, detection);
  // A shape makes no phantom of what lies where hardly anything makes some.
  track.phantom = m.phantom ? std::min(with, std::max(without, m.phantom->cause)) : without;
}

void phantomMiss(const MeasurementScan& scan, double detection, Track& track) {
  if (track.phantom <= 0) return;
  track.phantom = weighed(track.phantom, 1 - phantomDetection(track, scan), 1 - detection);
}

}  // namespace perception
