#include "libperception/pipeline/phantoms/WakeWatch.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "libperception/filter/state/ClassFilterMotion.h"

namespace perception {
namespace {

// All assumed.
constexpr double kLeastSpeed = 5;    // [m/s] of a vehicle with a wake
constexpr double kWakeExists = 0.9;  // of its track
constexpr double kLeastAge = 0.5;    // [s] of its track
constexpr int kLeastHits = 4;
constexpr double kKnownSpeed = 1.5;        // [m/s] deviation of a speed that needs neither
constexpr double kLeastProbability = 0.5;  // of being a vehicle
constexpr double kWakeMemory = 10;         // [s] of phantoms seen, as of clutter
constexpr double kWide = 1000;             // [m^2] of wakes without a phantom, to begin with
constexpr double kMisjudged = 0.3;         // share of phantoms that are not told by their shape
constexpr double kLongestStep = 0.3;       // [s] between two footprints of a track
constexpr double kCame = 1;                // [s] for which it drove before its first one
constexpr double kWay = 1.5;               // [s] over which its velocity is taken
constexpr double kLeastWay = 0.5;          // [s]
constexpr double kThere = 0.5;             // of a track that is not lost
constexpr double kGoesOn = 2.5;            // [s] for which a lost one goes on
constexpr double kSpray = 2;               // phantoms remembered by which spray is as likely as not
constexpr double kNone = 0.05;             // phantoms remembered: fewer are none

/// [m/s] by the likeliest class.
Vector2 velocityOf(const Track& track, const ClassTable& classes) {
  const ClassId best = track.likeliestClass();
  const ClassFilter& f = track.bank[track.filterOf(static_cast<std::size_t>(best))];
  return kinematicsOf(classes[best], f).q.segment<2>(2);
}

/// The vehicle of a track that has a wake; empty: it has none.
std::optional<VehicleFootprint> vehicleOf(const Track& track, const ClassTable& classes,
                                          Stamp stamp) {
  const int hits = std::accumulate(track.hits.begin(), track.hits.end(), 0);
  if (track.real() < kWakeExists || hits < 2) return std::nullopt;
  const ClassId best = track.likeliestClass();
  const auto i = static_cast<std::size_t>(best);
  if (classes[best].shape != ObjectShape::kVehicle ||
      track.log_class[i] < std::log(kLeastProbability))
    return std::nullopt;
  const ClassFilter& f = track.bank[track.filterOf(i)];
  const Vector2 velocity = velocityOf(track, classes);
  const double speed = velocity.norm();
  if (speed < kLeastSpeed) return std::nullopt;
  if (stamp - track.birth < kLeastAge || hits < kLeastHits) {
    const Matrix4 J = kinematicsOf(classes[best], f).J.topRows<4>();
    const Matrix2 P = (J * f.P * J.transpose()).bottomRightCorner<2, 2>();
    const Vector2 ahead = velocity / speed;
    if (ahead.dot(P * ahead) > kKnownSpeed * kKnownSpeed) return std::nullopt;
  }
  VehicleFootprint v;
  v.stamp = stamp;
  v.along = velocity / speed, v.speed = speed;
  v.center = f.x.head<2>() + (stamp - track.stamp) * velocity;
  v.half_length = f.extent.length / 2, v.half_width = f.extent.width / 2;
  return v;
}

/// The last footprint, with the mean velocity of the way there: before it is lost, a track is often
/// drawn back into its cloud.
VehicleFootprint goesOn(const std::deque<VehicleFootprint>& way) {
  VehicleFootprint last = way.back();
  const double t = last.stamp - way.front().stamp;
  const Vector2 moved = last.center - way.front().center;
  if (t < kLeastWay || moved.norm() < kLeastSpeed * t) return last;
  last.along = moved.normalized(), last.speed = moved.norm() / t;
  return last;
}

}  // namespace

WakeWatch::WakeWatch(const std::vector<PipelineSetup::Sensor>& sensors, const ClassTable& classes)
    : sensors_(sensors), classes_(classes), seen_(sensors.size()) {}

std::shared_ptr<const WakeMap> WakeWatch::at(Stamp stamp) const {
  if (wakes_.empty()) return nullptr;
  auto wakes = std::make_shared<WakeMap>(wakes_);
  wakes->advance(stamp);
  return wakes;
}

double WakeWatch::spray(std::size_t sensor, Stamp stamp) const {
  const Seen& seen = seen_[sensor];
  const double phantoms = seen.phantoms * std::exp(-(stamp - seen.stamp) / kWakeMemory);
  return phantoms >= kNone ? phantoms / (phantoms + kSpray) : 0;
}

void WakeWatch::apply(std::size_t sensor, MeasurementScan& scan, double clutter_per_scan) const {
  if ((wakes_.empty() && gone_.empty()) ||
      std::none_of(seen_.begin(), seen_.end(), [](const Seen& s) { return s.phantoms >= kNone; }))
    return;
  auto wakes = std::make_shared<WakeMap>(wakes_);
  wakes->advance(scan.state.stamp);
  const Seen& seen = seen_[sensor];
  const DetectionParams& params = sensors_[sensor].params;
  const double view =
      params.fov / 2 * (params.range_max * params.range_max - params.range_min * params.range_min);
  if (seen.phantoms >= kNone && clutter_per_scan > 0)
    wakes->density = kMisjudged * seen.phantoms / (seen.area + kWide) / (clutter_per_scan / view);
  for (const VehicleFootprint& v : gone_) wakes->add(v);
  scan.wakes = std::move(wakes);
}

void WakeWatch::add(std::size_t sensor, const MeasurementScan& scan, const Hypothesis& hypothesis) {
  wakes_.advance(scan.state.stamp);
  if (scan.modality == Modality::kLidar) addVehicles(scan.state.stamp, hypothesis);
  if (scan.verdicts) count(scan, seen_[sensor]);
}

void WakeWatch::count(const MeasurementScan& scan, Seen& seen) const {
  const Stamp now = scan.state.stamp;
  const double keep = seen.stamp.ns != 0 ? std::exp(-(now - seen.stamp) / kWakeMemory) : 0;
  seen.phantoms *= keep, seen.area *= keep;
  seen.stamp = now;
  seen.area += wakes_.area(now);
  for (const PhantomCluster& phantom : scan.verdicts->phantoms) {
    const Vector3 place =
        scan.state.ego.T_world_ego * Vector3(phantom.center.x(), phantom.center.y(), 0);
    if (wakes_.age(place.head<2>(), now) || wakes_.cameBy(place.head<2>(), now)) seen.phantoms += 1;
  }
}

void WakeWatch::addVehicles(Stamp stamp, const Hypothesis& hypothesis) {
  std::map<std::uint64_t, std::deque<VehicleFootprint>> driving;
  for (const TrackHandle& track : hypothesis.tracks) {
    auto vehicle = vehicleOf(*track, classes_, stamp);
    if (!vehicle) continue;
    const auto before = last_.find(track->id);
    if (before == last_.end())
      vehicle->came = kCame * vehicle->speed;
    else
      vehicle->advanced =
          vehicle->speed * std::min(kLongestStep, stamp - before->second.back().stamp);
    wakes_.add(*vehicle);
    auto& way = driving[track->id];
    if (before != last_.end()) way = std::move(before->second);
    way.push_back(*vehicle);
    while (stamp - way.front().stamp > kWay) way.pop_front();
    lost_.erase(track->id);
  }
  for (const auto& [id, way] : last_)
    if (driving.count(id) == 0) lost_[id] = {stamp, goesOn(way)};
  last_ = std::move(driving);
  for (const TrackHandle& track : hypothesis.tracks) {
    const auto lost = lost_.find(track->id);
    if (lost == lost_.end() || track->real() < kThere) continue;
    if (velocityOf(*track, classes_).norm() < kLeastSpeed)
      lost_.erase(lost);  // it is known to be slow now
    else
      lost->second.since = stamp;  // it is not lost yet
  }
  goOn(stamp);
}

/// A vehicle is not gone with its track: its wake goes on where it must be.
void WakeWatch::goOn(Stamp stamp) {
  for (auto lost = lost_.begin(); lost != lost_.end();) {
    if (stamp - lost->second.since > kGoesOn) {
      lost = lost_.erase(lost);
      continue;
    }
    VehicleFootprint& v = lost->second.vehicle;
    v.came = v.speed * (stamp - v.stamp);
    v.center += v.came * v.along;
    v.stamp = stamp;
    v.half_length = v.advanced = 0;  // the way up to its middle
    gone_.push_back(v);
    ++lost;
  }
  while (!gone_.empty() && stamp - gone_.front().stamp > kGoesOn) gone_.pop_front();
}

void WakeWatch::restart() {
  wakes_ = {};
  last_.clear(), lost_.clear(), gone_.clear();
}

}  // namespace perception
