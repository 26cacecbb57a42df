#include "libperception/filter/likelihood/PhantomOdds.h"

#include <algorithm>
#include <cmath>

#include "libperception/filter/state/ClassFilterMotion.h"

namespace perception {
namespace {

// All assumed.
constexpr double kSeenElsewhere = 0.02;         // P(a phantom is seen) outside of wakes
constexpr double kDrift = 3, kDriftSpread = 1;  // [m/s] of spray, by the wind

Vector2 placeOf(const Track& track) {
  return track.bank[track.filterOf(static_cast<std::size_t>(track.likeliestClass()))].x.head<2>();
}

double phantomDetection(const Track& track, const MeasurementScan& scan) {
  if (!scan.wakes) return kSeenElsewhere;
  const auto age = scan.wakes->age(placeOf(track), scan.state.stamp);
  return age ? WakeMap::detection(scan.modality, *age) : kSeenElsewhere;
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

void weigh(double as_phantom, double as_object, Track& track) {
  const double phantom = track.phantom * as_phantom, object = (1 - track.phantom) * as_object;
  if (phantom + object > 0) track.phantom = phantom / (phantom + object);
}

}  // namespace

double phantomDensity(const Vector2& place, const MeasurementScan& scan) {
  if (!scan.wakes || scan.wakes->density <= 0) return 0;
  return scan.wakes->age(place, scan.state.stamp) ? scan.wakes->density : 0;
}

double detectionWithPhantom(const Track& track, const MeasurementScan& scan, double detection) {
  return (1 - track.phantom) * detection + track.phantom * phantomDetection(track, scan);
}

void phantomHit(const MeasurementScan& scan, double detection, const FilterModel& model,
                Track& track) {
  if (track.phantom <= 0) return;
  weigh(phantomDetection(track, scan) * drifts(track, model), detection, track);
}

void phantomMiss(const MeasurementScan& scan, double detection, Track& track) {
  if (track.phantom <= 0) return;
  weigh(1 - phantomDetection(track, scan), 1 - detection, track);
}

}  // namespace perception
