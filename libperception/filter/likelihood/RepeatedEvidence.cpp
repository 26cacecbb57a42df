#include "libperception/filter/likelihood/RepeatedEvidence.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libperception/core/math/LogMath.h"
#include "libperception/filter/state/ClassFilterMotion.h"

namespace perception {
namespace {

const EvidenceSeen* seenBy(const Track& track, const std::string& sensor) {
  if (track.evidence.empty()) return nullptr;
  const std::uint64_t key = sensorKey(sensor);
  for (const EvidenceSeen& e : track.evidence)
    if (e.sensor == key) return &e;
  return nullptr;
}

constexpr double kNearest = 0.1;    // [m] least range of a view
constexpr double kLeastSaid = -12;  // under the likeliest class: a class never detected there

/// Weight of the evidence for vehicles of many returns, and returns with half of it (views of
/// vehicles by models that have not seen the recording: docs/decisions/lidar.md).
constexpr double kVehicleWeight = 1.3, kFewReturns = 15;

/// [m/s] at which a post or trunk may seem to move, as its visible part changes (assumed).
constexpr double kStandingSpeed = 0.5;

/// How sure it is that the track, if it is of class j, moves: 0 up to kStandingSpeed, near 1 where
/// its speed lies many deviations beyond that.
double sureOfMotion(const Track& track, std::size_t j) {
  const ClassFilter& f = track.bank[track.filterOf(j)];
  const Vector2 v = f.x.tail<2>();
  const double speed = v.norm();
  if (speed <= kStandingSpeed) return 0;
  const double variance = v.dot(f.P.bottomRightCorner<2, 2>() * v) / (speed * speed);
  return std::erf((speed - kStandingSpeed) / std::sqrt(2 * variance));
}

/// Whether a front end has judged all clusters of a scan to be no phantoms.
bool isClearAir(const MeasurementScan& scan) {
  return scan.verdicts && scan.verdicts->suspicious == 0 && scan.verdicts->phantoms.empty();
}

EvidenceView viewOf(const Track& track, const MeasurementScan& scan) {
  const auto c = static_cast<std::size_t>(track.likeliestClass());
  const Vector2 d =
      scan.state.T_world_sensor.translation().head<2>() - track.bank[track.filterOf(c)].x.head<2>();
  return {std::atan2(d.y(), d.x()), std::log(std::max(d.norm(), kNearest))};
}

/// Relative to the likeliest class.
void limit(ClassValues& said) {
  const double best = *std::max_element(said.begin(), said.end());
  for (double& value : said) value = best > kMinusInfinity ? std::max(value - best, kLeastSaid) : 0;
}

}  // namespace

std::optional<Look> lookOf(const Track& track, const Measurement& m, const MeasurementScan& scan,
                           const ClassValues& detection) {
  Look look;
  if (m.view && (look.memory = scan.model->evidenceMemory())) {
    look.view = *m.view;
    if (m.phantom) look.phantom = m.phantom->evidence;
    look.said.resize(m.log_class.size());
    std::copy(m.log_class.begin(), m.log_class.end(), look.said.begin());
    return look;
  }
  look.memory = scan.model->lookMemory();
  if (!look.memory) return {};
  look.view = viewOf(track, scan);
  look.said.resize(detection.size());
  for (std::size_t j = 0; j < detection.size(); ++j)
    look.said[j] =
        logLabelAndScore(*scan.model, m, static_cast<ClassId>(j)) + std::log(detection[j]);
  limit(look.said);
  return look;
}

std::optional<Look> weighedLookOf(const Track& track, const Measurement& m,
                                  const MeasurementScan& scan, const ClassValues& detection,
                                  const ClassTable& classes) {
  std::optional<Look> look = lookOf(track, m, scan, detection);
  if (!look || !m.view) return look;
  const double returns = look->view.returns;
  const double vehicle = isClearAir(scan) && seenBy(track, scan.sensor)
                             ? std::max(1.0, kVehicleWeight * returns / (returns + kFewReturns))
                             : 1;
  const double pedestrian = look->memory->pedestrianWeight(returns);
  for (std::size_t j = 0; j < look->said.size(); ++j) {
    if (look->said[j] <= 0) continue;
    const ObjectShape shape = classes[static_cast<ClassId>(j)].shape;
    if (shape == ObjectShape::kVehicle) look->said[j] *= vehicle;
    if (shape == ObjectShape::kPedestrian && pedestrian < 1)
      look->said[j] *= pedestrian + (1 - pedestrian) * sureOfMotion(track, j);
  }
  return look;
}

std::optional<Look> missedLook(const Track& track, const MeasurementScan& scan,
                               const ClassValues& detection, double visible) {
  Look look;
  look.memory = scan.model->lookMemory();
  if (!look.memory || visible <= 0) return {};
  look.view = viewOf(track, scan);
  look.weight = visible;
  look.said.resize(detection.size());
  for (std::size_t j = 0; j < detection.size(); ++j) look.said[j] = std::log1p(-detection[j]);
  limit(look.said);
  return look;
}

ClassValues detectionAtBirth(const Measurement& m, const MeasurementScan& scan,
                             const FilterModel& model) {
  ClassValues detection;
  detection.assign(static_cast<std::size_t>(model.classes.size()), 0);
  for (ClassId j = 0; j < model.classes.size(); ++j) {
    const auto birth = scan.model->birth(m, j, scan.state);
    if (!birth) continue;
    ClassFilter f;
    f.x.head<2>() = birth->position;
    detection[static_cast<std::size_t>(j)] = scan.model->detectionProbability(
        j, kinematicsOf(model.classes[j], f), birth->extent, scan.state, 1);
  }
  return detection;
}

RepeatedEvidence::RepeatedEvidence(const Track& track, Look look, const MeasurementScan& scan,
                                   double epsilon)
    : look_(std::move(look)) {
  seen_ = seenBy(track, scan.sensor);
  if (!seen_) return;
  const EvidenceMemory& memory = *look_.memory;
  worth_ = EvidenceMemory::worth(
      memory.correlation(look_.view, seen_->view, scan.state.stamp - seen_->stamp));
  kept_ = seen_->views * memory.say(look_.view, seen_->view);
  if (epsilon <= 0) return;
  floor_ = std::log(epsilon);
  best_before_ = best_now_ = -std::numeric_limits<double>::infinity();
  for (std::size_t j = 0; j < look_.said.size(); ++j) {
    best_before_ = std::max(best_before_, memory.looks(seen_->views) * seen_->mean[j]);
    best_now_ = std::max(best_now_, memory.looks(views()) * mean(j));
  }
}

double RepeatedEvidence::total(double looks, double value, double best) const {
  return std::max(looks * value, best + floor_);
}

double RepeatedEvidence::added(std::size_t j) const {
  if (!seen_) return look_.said[j];
  return total(look_.memory->looks(views()), mean(j), best_now_) -
         total(look_.memory->looks(seen_->views), seen_->mean[j], best_before_);
}

double RepeatedEvidence::mean(std::size_t j) const {
  return mean(look_.said[j], seen_ ? seen_->mean[j] : 0);
}

double RepeatedEvidence::mean(double said, double mean_before) const {
  if (!seen_) return said;
  const double before = kept_ * seen_->returns, now = worth_ * look_.view.returns;
  return (before * mean_before + now * said) / (before + now * look_.weight);
}

double RepeatedEvidence::phantomAdded() const {
  if (!seen_) return look_.phantom;
  const EvidenceMemory& memory = *look_.memory;
  return memory.looks(views()) * phantomMean() - memory.looks(seen_->views) * seen_->phantom;
}

double RepeatedEvidence::returns() const {
  if (!seen_) return look_.view.returns;
  const double worth = worth_ * look_.weight;
  return (kept_ * seen_->returns + worth * look_.view.returns) / (kept_ + worth);
}

double rememberEvidence(const Look& look, const MeasurementScan& scan, Track& track) {
  const RepeatedEvidence evidence(track, look, scan);
  const double added = evidence.phantomAdded();  // borrows what is replaced below
  const std::uint64_t key = sensorKey(scan.sensor);
  EvidenceSeen now{key, scan.state.stamp, look.view, evidence.views(), evidence.returns(), {}, 0};
  now.phantom = evidence.phantomMean();
  for (std::size_t j = 0; j < look.said.size(); ++j) now.mean.push_back(evidence.mean(j));
  const auto seen = std::find_if(track.evidence.begin(), track.evidence.end(),
                                 [&](const EvidenceSeen& e) { return e.sensor == key; });
  if (seen == track.evidence.end()) {
    track.evidence.push_back(std::move(now));
  } else {
    *seen = std::move(now);
  }
  return added;
}

void rememberBirth(const Measurement& m, const MeasurementScan& scan, const FilterModel& model,
                   Track& track) {
  ClassValues detection;
  if (scan.model->lookMemory()) detection = detectionAtBirth(m, scan, model);
  const auto look = weighedLookOf(track, m, scan, detection, model.classes);
  if (!look) return;
  rememberEvidence(*look, scan, track);
  for (std::size_t j = 0; m.view && j < m.log_class.size(); ++j)
    if (look->said[j] != m.log_class[j]) track.log_class[j] += look->said[j] - m.log_class[j];
}

}  // namespace perception
