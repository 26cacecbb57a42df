#include "libperception/pipeline/health/FamiliarPlaces.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "libperception/core/math/Angle.h"
#include "libperception/radar/RadarModel.h"

namespace perception {
namespace {

// All assumed.
constexpr double kPlaceCell = 2, kSamePlace = 2.5;           // [m]
constexpr double kPlaceShift = 0.3;                          // of a place to what is seen of it
constexpr double kPlaceMemory = 10, kPlaceForgotten = 0.05;  // [s], remembered hits
constexpr double kPlaceHits = 3, kPlaceVain = 2, kMostPlace = 0.9;
constexpr double kPlaceExponent = 0.5;       // what hides one place hides its neighbors
constexpr double kPlaceMoved = 2;            // [m] by which a wall looks different to a radar
constexpr double kPlaceBorder = radians(1);  // of the view
constexpr double kStandingRate = 1;          // [m/s]
constexpr double kOfObject = 3;              // [m] from an object

/// Whether a return stands, by its range rate.
bool standsStill(const Measurement& m, const SensorState& state) {
  if (m.z.size() < 3 || m.seen != RadarModel::kAll) return false;
  const double bearing = yawOf(state.T_world_sensor) + m.z[1];
  const Vector2 u(std::cos(bearing), std::sin(bearing));
  return std::abs(m.z[2] + u.dot(sensorVelocity(state))) < kStandingRate;
}

bool isPlaceInView(const Vector2& place, const SensorState& state,
                   const FamiliarPlaces::View& view) {
  const Vector2 d = place - state.T_world_sensor.translation().head<2>();
  return d.norm() <= view.range_max &&
         std::abs(wrapAngle(std::atan2(d.y(), d.x()) - yawOf(state.T_world_sensor))) <=
             0.5 * view.fov - kPlaceBorder;
}

}  // namespace

FamiliarPlaces::Cell FamiliarPlaces::cellOf(const Vector2& place) {
  return {std::lround(place.x() / kPlaceCell), std::lround(place.y() / kPlaceCell)};
}

void FamiliarPlaces::add(const MeasurementScan& scan, bool silent, const View& view,
                         const std::vector<Vector2>& tracked, const StillThere& stillThere) {
  forget(scan.state.stamp);
  if (silent) return miss(scan, view, stillThere);
  log_missed_ = 0;
  const Vector2 from = scan.state.T_world_sensor.translation().head<2>();
  for (const Measurement& m : scan.measurements) {
    const bool object = std::any_of(tracked.begin(), tracked.end(), [&](const Vector2& t) {
      return (m.position - t).norm() < kOfObject;
    });
    if (!object && standsStill(m, scan.state)) see(m.position, from);
  }
  for (auto& [cell, place] : places_)
    place.looks += place.hit || isPlaceInView(place.at, scan.state, view);
}

void FamiliarPlaces::forget(Stamp now) {
  const double keep = last_ ? std::exp(-std::max(0.0, now - *last_) / kPlaceMemory) : 1;
  last_ = now;
  for (auto it = places_.begin(); it != places_.end();) {
    Place& place = it->second;
    place.hits *= keep, place.looks *= keep, place.hit = false;
    it = place.hits < kPlaceForgotten ? places_.erase(it) : std::next(it);
  }
}

void FamiliarPlaces::see(const Vector2& at, const Vector2& from) {
  const Cell middle = cellOf(at);
  Place* nearest = nullptr;
  double least = kSamePlace;
  for (long x = middle.first - 1; x <= middle.first + 1; ++x) {
    for (long y = middle.second - 1; y <= middle.second + 1; ++y) {
      const auto found = places_.find({x, y});
      if (found == places_.end()) continue;
      const double d = (found->second.at - at).norm();
      if (d < least) least = d, nearest = &found->second;
    }
  }
  if (nearest == nullptr) nearest = &(places_[middle] = {at, from, 0, 0, false});
  nearest->at += kPlaceShift * (at - nearest->at);
  nearest->seen_from = from;
  if (!std::exchange(nearest->hit, true)) ++nearest->hits;
}

void FamiliarPlaces::miss(const MeasurementScan& scan, const View& view,
                          const StillThere& stillThere) {
  const Vector2 from = scan.state.T_world_sensor.translation().head<2>();
  for (auto& [cell, place] : places_) {
    if (!isPlaceInView(place.at, scan.state, view)) continue;
    const bool familiar =
        place.hits >= kPlaceHits && (from - place.seen_from).norm() <= kPlaceMoved;
    if (familiar && stillThere(place.at)) {
      const double detection = std::min(kMostPlace, place.hits / (place.looks + kPlaceVain));
      log_missed_ += kPlaceExponent * std::log1p(-detection);
    }
    ++place.looks;
  }
}

}  // namespace perception
