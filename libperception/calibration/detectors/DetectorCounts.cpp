#include "libperception/calibration/detectors/DetectorCounts.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "libperception/core/math/Angle.h"
#include "libperception/evaluation/matching/TruthAlignment.h"
#include "libperception/evaluation/matching/TruthSelection.h"
#include "libperception/measurement/models/FootprintModel.h"

namespace perception {
namespace {

constexpr double kWider = 4;                  // [-] of the stated deviations: a match, not a gate
constexpr double kFarthest = 9.0;             // [-] normalized distance at those, three deviations
constexpr double kAbout = 2;                  // [m] of a labeled object: no clutter
constexpr double kLag = 1, kLagSlack = 0.06;  // [s] lag of the error correlation
constexpr int kSeenAtMost = 2;                // KITTI's occlusion: 3 is unknown
constexpr double kWhole = 0.7, kPart = 0.3;   // least shares seen of KITTI's "visible", "partly"

/// A labeled object in a sensor's view.
struct Candidate {
  const TruthObject* truth;
  ClassId class_id;
  Kinematics kinematics;
  Extent extent;
  AxisPrediction seen;
  double range;
};

Kinematics kinematicsOf(const TruthObject& o) {
  Kinematics k;
  k.q << o.position.x(), o.position.y(), 0, 0, o.yaw;
  k.has_yaw = true;
  return k;
}

/// Labeled objects of the model's classes, with the predicted measurement of each.
std::vector<Candidate> candidates(const MeasurementScan& scan,
                                  const std::vector<TruthObject>& labeled,
                                  const std::vector<std::string>& classes) {
  std::vector<Candidate> out;
  const Vector2 origin = scan.state.T_world_sensor.translation().head<2>();
  for (const TruthObject& o : labeled) {
    const ClassId c = classOfTruth(o.type, classes);
    if (isArea(o) || c < 0 || !std::isfinite(o.length) || !o.position.allFinite()) continue;
    Candidate k{&o, c, kinematicsOf(o), {o.length, o.width, 0, 0}, {}, 0};
    k.range = (o.position.head<2>() - origin).norm();
    scan.model->predict(&k.kinematics, &k.extent, 1, scan.state, &k.seen);
    if (k.seen.defined) out.push_back(std::move(k));
  }
  return out;
}

double normalizedDistance(const MeasurementModel& model, const Measurement& m,
                          const AxisVector& h) {
  const AxisVector y = residual(model, m, h);
  AxisMatrix R(y.size(), y.size());
  Eigen::Index row = 0;
  for (Eigen::Index i = 0; i < m.z.size(); ++i) {
    if (!(m.seen >> i & 1)) continue;
    Eigen::Index column = 0;
    for (Eigen::Index j = 0; j < m.z.size(); ++j)
      if (m.seen >> j & 1) R(row, column++) = m.R(i, j);
    ++row;
  }
  return y.dot((kWider * kWider * R).llt().solve(y));
}

/// Index of the candidate that each measurement lies on, or -1.
std::vector<int> match(const MeasurementScan& scan, const std::vector<Candidate>& objects) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
  for (std::size_t k = 0; k < scan.measurements.size(); ++k) {
    for (std::size_t i = 0; i < objects.size(); ++i) {
      const double d = normalizedDistance(*scan.model, scan.measurements[k], objects[i].seen.h);
      if (d < kFarthest) pairs.emplace_back(d, k, i);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  std::vector<int> of(scan.measurements.size(), -1);
  std::vector<char> taken(objects.size(), 0);
  for (const auto& [d, k, i] : pairs) {
    if (of[k] >= 0 || taken[i]) continue;
    of[k] = static_cast<int>(i);
    taken[i] = 1;
  }
  return of;
}

/// The errors of one detection that lies on an object.
void addErrors(const MeasurementScan& scan, const Measurement& m, const Candidate& object,
               DetectorError base, std::vector<DetectorError>& out) {
  const auto add = [&](const char* quantity, double error, double sigma) {
    base.quantity = quantity, base.error = error, base.sigma = sigma;
    if (std::isfinite(error) && sigma > 0) out.push_back(base);
  };
  const TruthObject& truth = *object.truth;
  if (scan.model->axes().size() == FootprintModel::kAxes) {
    constexpr const char* kNames[] = {"left", "right", "range"};
    for (int axis = 0; axis < FootprintModel::kAxes; ++axis) {
      if (!(m.seen >> axis & 1)) continue;
      const double error = m.z[axis] - object.seen.h[axis];
      const bool angle = scan.model->axes()[static_cast<std::size_t>(axis)] == AxisKind::kAngle;
      add(kNames[axis], angle ? wrapAngle(error) : error, std::sqrt(m.R(axis, axis)));
    }
  } else if (m.z.size() == 2 && m.seen == 3) {  // a place: along and across the line of sight
    const Vector2 sight =
        truth.position.head<2>() - scan.state.T_world_sensor.translation().head<2>();
    const Vector2 along = sight.normalized(), across(-along.y(), along.x());
    const Vector2 d = m.z - object.seen.h;
    const Matrix2 R = m.R;
    add("range", along.dot(d), std::sqrt(along.dot(R * along)));
    add("across", across.dot(d), std::sqrt(across.dot(R * across)));
  }
  if (m.height) add("height", m.height->mean - truth.height, std::sqrt(m.height->variance));
  if (m.base_z) add("base", m.base_z->mean - truth.position.z(), std::sqrt(m.base_z->variance));
  if (m.sides && m.sides->length_sigma > 0) {
    add("length", m.sides->length - truth.length, m.sides->length_sigma);
    add("width", m.sides->width - truth.width, m.sides->width_sigma);
  }
  if (m.heading) add("axis", wrapAxis(m.heading->yaw - truth.yaw), m.heading->sigma);
}

bool nearLabeled(const Measurement& m, const std::vector<TruthObject>& labeled) {
  return std::any_of(labeled.begin(), labeled.end(), [&](const TruthObject& o) {
    return std::isfinite(o.length) && o.position.allFinite() &&
           (o.position.head<2>() - m.position).norm() < std::max(kAbout, 0.5 * o.length);
  });
}

/// KITTI's occlusion by the share of an object's directions that something nearer hides.
int occlusionOf(const Candidate& object, const OcclusionMap& hiding, const Vector2& origin,
                double tolerance) {
  const double radius = 0.25 * (object.extent.length + object.extent.width);
  if (object.range <= radius) return 0;
  const Vector2 d = object.truth->position.head<2>() - origin;
  const double bearing = std::atan2(d.y(), d.x()), half = std::asin(radius / object.range);
  const double seen =
      hiding.visibility(bearing - half, bearing + half, object.range - radius, tolerance);
  return seen >= kWhole ? 0 : seen >= kPart ? 1 : 2;
}

/// Scans of one sensor with their instants, as alignTruth() takes them.
struct SensorScans {
  TrackedRun instants;
  std::vector<std::shared_ptr<const MeasurementScan>> scans;
  std::vector<std::shared_ptr<const OcclusionMap>> hiding;

  void add(Stamp first, std::shared_ptr<const MeasurementScan> scan,
           std::shared_ptr<const OcclusionMap> map) {
    instants.first_stamp = first;
    Scene& scene = instants.scenes.emplace_back();
    scene.stamp = scan->state.stamp, scene.frame = scan->frame;
    scans.push_back(std::move(scan));
    hiding.push_back(std::move(map));
  }
};

/// Adds up one sensor's scans of one log.
class SensorCounter {
 public:
  SensorCounter(const RecordedLog& log, std::size_t log_index, const std::string& sensor,
                std::size_t labels, DetectorCounts& sum)
      : log_(log), log_index_(log_index), sum_(sum) {
    for (const ObjectClass& c : log.model.classes.classes) classes_.push_back(c.name);
    sum_.sensor = sensor;
    sum_.clutter.resize(labels);
  }

  void add(const MeasurementScan& scan, const OcclusionMap* hiding,
           const std::vector<TruthObject>& labeled) {
    sum_.modality = scan.modality;
    ++sum_.scans;
    if (sum_.label.empty()) addTable(scan);
    const double t = scan.state.stamp - log_.first_stamp;
    const auto objects = candidates(scan, labeled, classes_);
    const auto of = match(scan, objects);
    std::vector<int> label_of(objects.size(), -1);
    ClutterCount& here = sum_.clutter_scans.emplace_back();
    here.log = log_index_, here.t = t;
    for (std::size_t k = 0; k < of.size(); ++k) {
      const Measurement& m = scan.measurements[k];
      if (of[k] < 0) {
        if (nearLabeled(m, labeled)) continue;
        ++sum_.clutter[static_cast<std::size_t>(m.label)], ++here.number;
        continue;
      }
      const Candidate& o = objects[static_cast<std::size_t>(of[k])];
      label_of[static_cast<std::size_t>(of[k])] = m.label;
      if (hiddenBy(scan, hiding, o) > kSeenAtMost) continue;
      addErrors(scan, m, o, {o.class_id, "", o.range, 0, 1, log_index_, o.truth->id, t},
                sum_.errors);
    }
    for (std::size_t i = 0; i < objects.size(); ++i)
      addChance(scan, hiding, objects[i], label_of[i], t, here);
  }

 private:
  void addTable(const MeasurementScan& scan) {
    for (ClassId c = 0; c < log_.model.classes.size(); ++c) {
      auto& row = sum_.label.emplace_back();
      for (std::size_t l = 0; l < sum_.clutter.size(); ++l)
        row.push_back(std::exp(scan.model->logLabelLikelihood(static_cast<int>(l), c)));
    }
  }

  /// KITTI's occlusion, by the label or by what hides objects.
  int hiddenBy(const MeasurementScan& scan, const OcclusionMap* hiding, const Candidate& o) const {
    if (o.truth->occluded <= kSeenAtMost || hiding == nullptr) return o.truth->occluded;
    const Vector2 origin = scan.state.T_world_sensor.translation().head<2>();
    return occlusionOf(o, *hiding, origin, log_.model.params.occlusion_tolerance);
  }

  void addChance(const MeasurementScan& scan, const OcclusionMap* hiding, const Candidate& o,
                 int label, double t, ClutterCount& here) {
    const double stated =
        scan.model->detectionProbability(o.class_id, o.kinematics, o.extent, scan.state, 1);
    const int occluded = hiddenBy(scan, hiding, o);
    if (stated <= 0 || occluded > kSeenAtMost || o.truth->ignore) return;
    sum_.chances.push_back({o.class_id, occluded, o.range, label, stated, log_index_, t});
    if (label >= 0 && met_.insert(o.truth->id).second) ++sum_.first_seen, ++here.entered;
  }

  const RecordedLog& log_;
  std::size_t log_index_;
  DetectorCounts& sum_;
  std::vector<std::string> classes_;
  std::set<std::int64_t> met_;  ///< objects that were detected
};

}  // namespace

void countDetections(const RecordedLog& log, const GroundTruth& truth, std::size_t log_index,
                     const std::map<std::string, std::size_t>& labels,
                     std::map<std::string, DetectorCounts>& counts) {
  std::map<std::string, SensorScans> sensors;
  std::shared_ptr<const OcclusionMap> hiding;
  for (const RecordedLog::Entry& entry : log.entries) {
    if (entry.kind == RecordedLog::Entry::kRestart) hiding.reset();
    if (entry.kind != RecordedLog::Entry::kScan) continue;
    if (entry.scan->occlusion) hiding = entry.scan->occlusion;
    if (labels.count(entry.scan->sensor) == 0) continue;
    sensors[entry.scan->sensor].add(log.first_stamp, entry.scan, hiding);
  }
  for (const auto& [label, scans] : sensors) {
    const auto known = alignTruth(scans.instants, truth, {}).instants;
    if (known.empty()) continue;
    SensorCounter counter(log, log_index, label, labels.at(label), counts[label]);
    for (const TruthAtScene& instant : known)
      counter.add(*scans.scans[instant.scene], scans.hiding[instant.scene].get(), instant.objects);
  }
}

ErrorFigures figuresOf(const std::vector<const DetectorError*>& errors) {
  ErrorFigures f;
  f.count = errors.size();
  if (errors.empty()) return f;
  std::map<std::pair<std::size_t, std::int64_t>, std::vector<const DetectorError*>> by_object;
  for (const DetectorError* e : errors) {
    f.mean += e->error, f.rms += e->error * e->error, f.stated += e->sigma * e->sigma;
    f.nis += std::pow(e->error / e->sigma, 2);
    by_object[{e->log, e->object}].push_back(e);
  }
  const double n = static_cast<double>(f.count);
  f.mean /= n, f.nis /= n;
  f.rms = std::sqrt(f.rms / n), f.stated = std::sqrt(f.stated / n);
  double product = 0, pairs = 0;
  for (const auto& [key, own] : by_object) {
    std::size_t later = 0;
    for (const DetectorError* e : own) {
      while (later < own.size() && own[later]->t < e->t + kLag - kLagSlack) ++later;
      if (later == own.size()) break;
      if (own[later]->t > e->t + kLag + kLagSlack) continue;
      product += (e->error / e->sigma) * (own[later]->error / own[later]->sigma), pairs += 1;
    }
  }
  if (pairs > 0 && f.nis > 0) f.repeated = product / pairs / f.nis;
  return f;
}

}  // namespace perception
