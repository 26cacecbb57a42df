#include "libperception/measurement/frames/WakeMap.h"

#include <algorithm>
#include <cmath>

namespace perception {
namespace {

// All assumed.
constexpr double kLife = 2.5;                    // [s] of a wake
constexpr double kPresent = 0.15;                // [s] since the last footprint of a vehicle
constexpr double kSide = 0.5, kSpread = 0.7;     // [m], [m/s] by which it is wider than the vehicle
constexpr double kSeenAgain = 0.7, kFade = 1.5;  // by lidars; [s]
constexpr double kCell = 4;                      // [m]
constexpr double kByCameras = 0.02, kByRadars = 0.01;

double halfWidth(const VehicleFootprint& v, double age) {
  return v.half_width + kSide + kSpread * age;
}

// Number of the cell that contains a coordinate [m].
int cellOf(double coordinate) { return static_cast<int>(std::floor(coordinate / kCell)); }

}  // namespace

void WakeMap::add(const VehicleFootprint& vehicle) {
  vehicles_.push_back(vehicle);
  mark(vehicle);
  advance(vehicle.stamp);
}

void WakeMap::advance(Stamp now) {
  const std::size_t before = vehicles_.size();
  while (!vehicles_.empty() && now - vehicles_.front().stamp > kLife) vehicles_.pop_front();
  if (vehicles_.size() == before) return;
  reached_.fill(0), came_by_.fill(0);
  for (const VehicleFootprint& v : vehicles_) mark(v);
}

void WakeMap::markAround(const Vector2& place, double reach, Cells& cells) {
  const int last_x = cellOf(place.x() + reach), last_y = cellOf(place.y() + reach);
  for (int y = cellOf(place.y() - reach); y <= last_y; ++y)
    for (int x = cellOf(place.x() - reach); x <= last_x; ++x)
      cells[static_cast<std::size_t>(y & (kCells - 1))] |= std::uint64_t{1} << (x & (kCells - 1));
}

bool WakeMap::isMarked(const Vector2& place, const Cells& cells) {
  const std::uint64_t row = cells[static_cast<std::size_t>(cellOf(place.y()) & (kCells - 1))];
  return (row >> (cellOf(place.x()) & (kCells - 1)) & 1) != 0;
}

void WakeMap::mark(const VehicleFootprint& v) {
  const double width = halfWidth(v, kLife);
  markAround(v.center, v.half_length + std::max(kPresent * v.speed, v.advanced) + width, reached_);
  for (double behind = 0; behind < v.came; behind += kCell)
    markAround(v.center - (v.half_length + behind + kCell / 2) * v.along, kCell / 2 + width,
               came_by_);
}

std::optional<double> WakeMap::age(const Vector2& place, Stamp now) const {
  if (!isMarked(place, reached_)) return std::nullopt;
  for (auto v = vehicles_.rbegin(); v != vehicles_.rend(); ++v) {  // the last vehicle counts
    const double age = now - v->stamp;
    if (age > kLife) break;
    if (age < 0) continue;  // as was known at `now`
    const double moved = age <= kPresent ? age * v->speed : 0;
    const Vector2 d = place - v->center - moved * v->along;
    const double ahead = d.dot(v->along), behind = -v->half_length - ahead;  // [m] of the rear
    const bool swept = age > kPresent && behind > 0 && behind <= v->advanced;
    if (std::abs(ahead) > v->half_length && !swept) continue;
    if (std::abs(d.x() * v->along.y() - d.y() * v->along.x()) <= halfWidth(*v, age))
      return swept ? age + behind / v->speed : age;
  }
  return std::nullopt;
}

WakeMap::Past WakeMap::pastOf(const Vector2& place, Stamp now) const {
  if (const auto since = age(place, now)) return {*since > kPresent, false};
  if (!isMarked(place, came_by_)) return {};
  const bool came = std::any_of(vehicles_.begin(), vehicles_.end(), [&](const VehicleFootprint& v) {
    if (v.came <= 0) return false;
    const double age = now - v.stamp;
    if (age < 0 || age > kLife) return false;
    const Vector2 d = place - v.center;
    const double behind = -v.half_length - d.dot(v.along);  // [m] of the rear
    return behind > 0 && behind <= v.came &&
           std::abs(d.x() * v.along.y() - d.y() * v.along.x()) <= halfWidth(v, age);
  });
  return {false, came};
}

double WakeMap::area(Stamp now) const {
  double area = 0;
  for (const VehicleFootprint& v : vehicles_)
    area += 2 * (v.advanced + v.came) * halfWidth(v, now - v.stamp);
  return area;
}

double WakeMap::detection(Modality modality, double age) {
  if (modality == Modality::kCamera) return kByCameras;
  if (modality == Modality::kRadar) return kByRadars;
  return std::max(kByCameras, kSeenAgain * std::exp(-age / kFade));
}

}  // namespace perception
