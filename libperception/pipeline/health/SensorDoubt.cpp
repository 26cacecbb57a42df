#include "libperception/pipeline/health/SensorDoubt.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "libperception/filter/likelihood/LikelihoodRow.h"
#include "libperception/filter/state/ClassFilterMotion.h"
#include "libperception/measurement/models/MeasurementModel.h"

namespace perception {
namespace {

// All assumed.
constexpr double kMissExponent = 0.5;  // misses of one object are not independent
constexpr double kFouledShare = 0.35;  // of P_D that a fouled sensor has
constexpr double kOthersHit = 0.3;     // [s] since another modality saw the object
constexpr double kSteady = 1;          // [s] age of the objects that count
constexpr double kWorthALook = 0.4;    // P_D of the objects that count
constexpr double kMostDetection = 0.95;
constexpr double kLeastShare = 0.7;  // of the object that is open
constexpr double kSameObject = 3;    // [m] from a track to its measurement
constexpr double kRadarSpeed = 2;    // [m/s] that a radar tells from the ground
constexpr double kExists = 0.8;
// The detections that the share of P_D before any look is worth; least share.
constexpr double kLooksBefore = 4, kLeastSeen = 0.1;
constexpr double kMemory = 10;  // [s] of looks
// An object that this sensor saw so often is a witness whatever it is; its P_D is that of the
// tables times hits per expected hit, with so many more looks in vain.
constexpr double kFamiliarHits = 3, kVainLooks = 2;
constexpr double kBearingWindow = 2, kErrorTime = 0.5;    // [s]; of errors that are alike
constexpr double kLeastOffset = radians(2), kSigmas = 5;  // of a misaligned sensor
constexpr std::size_t kLeastBearings = 8;

/// Whether an object is there beyond doubt, by what other sensors have just seen.
bool isWitness(const Track& track, const MeasurementScan& scan) {
  if (track.real() < kExists || scan.state.stamp - track.birth < kSteady) return false;
  const std::size_t own = modalityIndex(scan.modality);
  for (std::size_t k = 0; k < track.last_hit.size(); ++k)
    if (k != own && scan.state.stamp - track.last_hit[k] <= kOthersHit) return true;
  return false;
}

/// Whether an object is nearer to a radar than it is long: the beam meets a part of its side, at a
/// slant, and the tables do not hold.
bool isBeside(const Kinematics& object, const Extent& extent, const MeasurementScan& scan) {
  const Vector2 from = scan.state.T_world_sensor.translation().head<2>();
  return scan.modality == Modality::kRadar && (object.q.head<2>() - from).norm() < extent.length;
}

/// Whether the sensor's tables say how often it detects the object: a road user whose class is
/// known; of radars, one that they tell from the ground.
bool isOfTables(const Track& track, const Kinematics& object, const MeasurementScan& scan,
                const FilterModel& model, ClassId c) {
  if (scan.modality == Modality::kRadar && object.q.segment<2>(2).norm() < kRadarSpeed)
    return false;
  return model.classes[c].reported &&
         std::exp(track.log_class[static_cast<std::size_t>(c)]) >= kExists;
}

/// Index of the measurement nearest to a place; empty: none within kSameObject.
std::optional<std::size_t> nearestTo(const Vector2& place, const MeasurementScan& scan) {
  std::optional<std::size_t> nearest;
  double least = kSameObject;
  for (std::size_t k = 0; k < scan.measurements.size(); ++k) {
    const double d = (scan.measurements[k].position - place).norm();
    if (d < least) least = d, nearest = k;
  }
  return nearest;
}

/// Bearing of a measurement minus the expected one [rad]: mean of the angles seen; of a position
/// that of the position.
std::optional<double> bearingError(const Measurement& m, const Kinematics& object,
                                   const Extent& extent, const MeasurementScan& scan) {
  const auto& kinds = scan.model->axes();
  if (std::find(kinds.begin(), kinds.end(), AxisKind::kAngle) == kinds.end()) {
    const Vector2 origin = scan.state.T_world_sensor.translation().head<2>();
    const Vector2 a = m.position - origin, b = object.q.head<2>() - origin;
    return wrapAngle(std::atan2(a.y(), a.x()) - std::atan2(b.y(), b.x()));
  }
  AxisPrediction p;
  scan.model->predict(&object, &extent, 1, scan.state, &p);
  if (!p.defined) return std::nullopt;
  const AxisVector error = residual(*scan.model, m, p.h);
  double sum = 0;
  int angles = 0;
  Eigen::Index at = 0;
  for (std::size_t axis = 0; axis < kinds.size(); ++axis) {
    if (!(m.seen >> axis & 1)) continue;
    if (kinds[axis] == AxisKind::kAngle) sum += error[at], ++angles;
    ++at;
  }
  return angles > 0 ? std::optional<double>(sum / angles) : std::nullopt;
}

}  // namespace

void SensorDoubt::add(const MeasurementScan& scan, const Hypothesis& tracks,
                      const FilterModel& model, double seen_share) {
  forget(scan.state.stamp);
  const std::size_t own = modalityIndex(scan.modality);
  for (const TrackHandle& track : tracks.tracks) {
    if (!isWitness(*track, scan)) continue;
    const ClassId c = track->likeliestClass();
    const ClassFilter& filter = track->bank[track->filterOf(static_cast<std::size_t>(c))];
    const Kinematics object = kinematicsOf(model.classes[c], filter);
    if (isBeside(object, filter.extent, scan)) continue;
    const double open = visibilityOf(*track, scan, model);
    if (open < kLeastShare) continue;
    const double table =
        scan.model->detectionProbability(c, object, filter.extent, scan.state, open) / seen_share;
    if (table <= 0) continue;  // out of view
    Looks& looks = looks_[track->id];
    const bool of_tables = table >= kWorthALook && isOfTables(*track, object, scan, model, c);
    const double familiar = looks.hits >= kFamiliarHits
                                ? table * looks.hits / (looks.expected + kVainLooks * table)
                                : 0;
    const bool seen = track->last_hit[own] == scan.state.stamp;
    looks.expected += table, looks.hits += seen, looks.last = scan.state.stamp;
    if (!seen && silent_ > 0)
      addMiss(std::min(std::max(of_tables ? table : 0, familiar), kMostDetection));
    if (!of_tables) continue;
    addLook(std::min(table, kMostDetection), seen);
    count_.expected += std::min(table, kMostDetection), count_.seen += seen;
    const auto place = seen ? nearestTo(object.q.head<2>(), scan) : std::nullopt;
    if (!place) continue;
    if (const auto error = bearingError(scan.measurements[*place], object, filter.extent, scan))
      addBearing(scan.state.stamp, track->id, *error);
  }
}

void SensorDoubt::forget(Stamp now) {
  if (last_) {
    const double keep = std::exp(-std::max(0.0, now - *last_) / kMemory);
    count_.expected *= keep, count_.seen *= keep;
    for (auto& [track, looks] : looks_) looks.expected *= keep, looks.hits *= keep;
  }
  last_ = now;
  for (auto it = looks_.begin(); it != looks_.end();)
    it = now - it->second.last > kMemory ? looks_.erase(it) : std::next(it);
}

void SensorDoubt::addLook(double detection, bool seen) {
  const double fouled = kFouledShare * detection;
  const double ratio = seen ? std::log(kFouledShare) : std::log((1 - fouled) / (1 - detection));
  fouled_ = std::max(0.0, fouled_ + kMissExponent * ratio);  // Page's test
}

void SensorDoubt::addMiss(double detection) {
  log_missed_ += kMissExponent * std::log1p(-detection);
}

double DetectionCount::share(double before) const {
  return std::clamp((before * kLooksBefore + seen) / (kLooksBefore + expected), kLeastSeen, 1.0);
}

void SensorDoubt::addBearing(Stamp stamp, std::uint64_t object, double error) {
  bearings_.push_back({stamp, object, error});
  while (stamp - bearings_.front().stamp > kBearingWindow) bearings_.pop_front();
}

double SensorDoubt::logSilence() const {
  return log_missed_ + (usual_ ? usual_->logSilence(static_cast<double>(silent_)) : 0);
}

std::optional<double> SensorDoubt::offset(Stamp now) const {
  double sum = 0, squares = 0, n = 0;
  std::map<std::uint64_t, std::pair<Stamp, Stamp>> spans;  // first and last look, by object
  for (const Bearing& b : bearings_) {
    if (now - b.stamp > kBearingWindow) continue;
    sum += b.error, squares += b.error * b.error, ++n;
    auto& span = spans.try_emplace(b.object, b.stamp, b.stamp).first->second;
    span.second = b.stamp;
  }
  if (n < kLeastBearings) return std::nullopt;
  double independent = 0;
  for (const auto& [object, span] : spans)
    independent += 1 + (span.second - span.first) / kErrorTime;
  const double mean = sum / n, variance = std::max(0.0, squares / n - mean * mean);
  const double sigma = std::sqrt(variance / std::min(n, independent));
  if (independent < 4 || std::abs(mean) < std::max(kLeastOffset, kSigmas * sigma))
    return std::nullopt;
  return mean;
}

}  // namespace perception
