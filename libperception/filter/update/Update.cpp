#include "libperception/filter/update/Update.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libperception/core/math/Chi2.h"
#include "libperception/core/math/KalmanUpdate.h"
#include "libperception/core/math/LogMath.h"
#include "libperception/filter/likelihood/PhantomOdds.h"
#include "libperception/filter/likelihood/RepeatedEvidence.h"
#include "libperception/filter/state/ClassFilterMotion.h"
#include "libperception/filter/update/ClassDecision.h"
#include "libperception/filter/update/ClassFilterUpdate.h"
#include "libperception/filter/update/HeadingUpdate.h"
#include "libperception/filter/update/SizeEvidence.h"
#include "libperception/filter/update/VelocityUpdate.h"
#include "libperception/measurement/models/PositionOnlyModel.h"
#include "libperception/measurement/objects/ExtentUpdate.h"

namespace perception {
namespace {

/// A class filter is reinitialized from the measurement beyond this probability (one true pair in
/// 10^5): a diverged extended Kalman filter would not recover, and its class could never become
/// probable again.
constexpr double kLostProbability = 1 - 1e-5;

/// A decided class is revoked beyond this one (one true pair in a hundred).
constexpr double kSurprisingProbability = 0.99;

double lostNis(Eigen::Index axes) {
  static const Chi2Quantiles<kMaxAxes> quantiles(kLostProbability);
  return quantiles.of(axes);
}

double surprisingNis(Eigen::Index axes) {
  static const Chi2Quantiles<kMaxAxes> quantiles(kSurprisingProbability);
  return quantiles.of(axes);
}

/// Floor and renormalization of the class posterior (method.md 5.6).
void clampClasses(double epsilon, std::vector<double>& log_class) {
  logNormalize(log_class);
  if (epsilon <= 0) return;
  const double floor = std::log(epsilon);
  if (std::none_of(log_class.begin(), log_class.end(), [&](double lp) { return lp < floor; }))
    return;
  for (double& lp : log_class) lp = std::max(lp, floor);
  logNormalize(log_class);
}

double speedSigma(const ObjectClass& c, const FilterModel& model) {
  return std::min(model.params.start_speed_sigma, std::max(0.5 * c.max_speed, 0.1));
}

/// The same of an object that may be as fast as its class can.
double fastSigma(const ObjectClass& c) { return 0.5 * c.max_speed; }

/// Whether a newborn's filter of this class holds a slow and a fast object. Not of a part of
/// something longer: what is seen of a crash barrier beside the vehicle goes along with it.
bool hasTwoSpeeds(const ObjectClass& c, double log_class, const Measurement& m,
                  const FilterModel& model) {
  constexpr double kLikely = 0.05;  // of an unlikely class a slow object is enough (assumed)
  const bool a_part = m.sides && !m.sides->length_complete && !m.sides->width_complete;
  return model.params.fast_births > 0 && c.motion->has_heading && !a_part &&
         fastSigma(c) > speedSigma(c, model) && log_class > std::log(kLikely);
}

/// The class's filter from one measurement. Wheeled objects start without heading unless the box
/// shows it.
ClassFilter startFilter(const ObjectClass& c, const BirthState& birth, const FilterModel& model,
                        bool two_speeds = false) {
  ClassFilter f;
  f.x.head<2>() = birth.position;
  f.P.topLeftCorner<2, 2>() = birth.covariance;
  f.extent = birth.extent;
  if (!c.motion->moves) return f;
  const double sigma = speedSigma(c, model);
  f.P(2, 2) = f.P(3, 3) = sigma * sigma;
  if (birth.radial_speed) updateVelocity(*birth.radial_speed, f);
  startModes(c, f);
  if (two_speeds && f.modes.empty() && !birth.radial_speed && !birth.speed)
    startTwoSpeeds(model.params.fast_births, fastSigma(c), f);
  if (c.motion->has_heading && birth.yaw) {
    const double extra = model.params.shape_yaw_sigma;
    orientByAxis(birth.yaw->mean, birth.yaw->variance + extra * extra, f);
    if (birth.speed) {
      f.x[2] = birth.speed->mean;
      f.P(2, 2) = birth.speed->variance;
      startModes(c, f);
    }
  }
  return f;
}

/// Velocity of a young filter by the motion of the measured cluster; without a heading that denies
/// it, from `birth`.
void moveBy(const RadialSpeed& seen, const ObjectClass& c, std::optional<BirthState> birth,
            const FilterModel& model, ClassFilter& f) {
  if (!c.motion->moves) return;
  if (birth && deniesHeading(seen, f)) {
    birth->yaw.reset();
    f = startFilter(c, *birth, model);
  }
  updateVelocity(seen, f);
}

/// Direction of a class's length axis [rad], if known.
std::optional<double> lengthAxis(const ObjectClass& c, const ClassFilter& f, const Track& track,
                                 const PartialBox& sides) {
  if (f.oriented) return f.x[3];
  if (!c.motion->moves) return sides.yaw;
  if (!c.motion->has_heading && track.body_heading) return track.body_heading->mean;
  return {};
}

/// Reinitializes a diverged filter from the measurement, with the velocity of the class of largest
/// likelihood.
ClassFilter restartFilter(const ObjectClass& c, const BirthState& birth, const Kinematics& best,
                          const FilterModel& model) {
  ClassFilter f = startFilter(c, birth, model);
  if (c.motion->moves && !f.oriented) {
    f.x.tail<2>() = best.q.segment<2>(2);
    startModes(c, f);
  }
  return f;
}

/// Heading and extent of a class's filter by the heading and the box of the measurement; the whole
/// filter anew where a box denies its axis.
void updateShape(const ObjectClass& c, const Measurement& m, const std::optional<BirthState>& birth,
                 const Track& track, const SensorState& sensor, const FilterModel& model,
                 ClassFilter& f) {
  if (boxDeniesAxis(m, birth, model.params, f)) f = startFilter(c, *birth, model);
  if (c.motion->has_heading && findHeading(m, birth, model.params, f) && m.view)
    takeSizeOfClass(c, sensor, f);
  if (m.sides) {
    if (const auto yaw = lengthAxis(c, f, track, *m.sides))
      f.extent = updateExtent(f.extent, *m.sides, *yaw, model.params.side_sigma);
  }
  if (c.reported && c.motion->has_heading)
    f.extent = boundedExtent(f.extent, c, m.view.has_value());
}

/// The length axis [rad] that the likeliest class with a heading gives the object.
std::optional<double> axisOf(const FilterModel& model, const Track& track) {
  std::optional<double> axis;
  double best = kMinusInfinity;
  for (ClassId j = 0; j < model.classes.size(); ++j) {
    const auto i = static_cast<std::size_t>(j);
    const ClassFilter& f = track.bank[track.filterOf(i)];
    if (!track.live(j) || !f.oriented || track.log_class[i] <= best) continue;
    best = track.log_class[i];
    axis = f.x[3];
  }
  return axis;
}

}  // namespace

Track hitTrack(Track predicted, const TrackLikelihoods& row, const PairLikelihood& pair,
               const MeasurementScan& scan, std::uint64_t scan_index, const FilterModel& model) {
  const Measurement& m = scan.measurements[pair.measurement];
  Track track = std::move(predicted);
  const std::optional<Look> look =
      weighedLookOf(track, m, scan, row.detection_by_class, model.classes);
  track.history = extendHistory(track.history, scan_index, pair.measurement);
  track.existence = model.params.existence_max;
  track.stands = pair.stands, track.goes_along = pair.goes_along, track.missed = 0;
  track.last_in_view = track.last_hit[modalityIndex(scan.modality)] = scan.state.stamp;
  ++track.hits[modalityIndex(scan.modality)];
  const auto best =
      static_cast<ClassId>(std::min_element(pair.nis.begin(), pair.nis.end()) - pair.nis.begin());
  const ClassId live = track.decided_class < 0 ? best : track.decided_class;
  const Kinematics best_kinematics =
      kinematicsOf(model.classes[live], track.bank[static_cast<std::size_t>(live)]);
  if (m.heading) updateBodyHeading(*m.heading, model.params, track);
  const PositionOnlyModel* place = row.predictions.empty() ? scan.model->positionOnly() : nullptr;
  const auto axes_seen = place ? 2 : residual(*scan.model, m, m.z).size();
  const bool young = isYoung(track, scan.modality);
  for (ClassId j = 0; j < model.classes.size(); ++j) {
    const ObjectClass& c = model.classes[j];
    const auto i = static_cast<std::size_t>(j);
    ClassFilter& f = track.bank[track.filterOf(i)];
    if (!track.live(j)) {
      track.log_class[i] += pair.log_class_evidence[i] +
                            model.params.kinematic_exponent * logSpeed(c, f, model.params);
      continue;
    }
    const bool is_lost = !(pair.nis[i] < lostNis(axes_seen));
    std::optional<BirthState> birth;
    if (is_lost || c.motion->has_heading) birth = scan.model->birth(m, j, scan.state);
    if (m.radial_speed && young) track.log_class[i] += logRadialSpeed(c, f, *m.radial_speed);
    const Vector2 expected = f.x.head<2>();
    const bool drives = f.oriented && movesSurely(f);
    if (!is_lost) {
      if (place)
        positionUpdate(m, place->placeNoise(j), f);
      else
        updateClassFilter(innovationOf(f, kinematicsOf(c, f), row.predictions[i], m, *scan.model),
                          f);
      if (m.radial_speed && young) moveBy(*m.radial_speed, c, birth, model, f);
      settleSpeeds(c, f);
      if (drives) correctWay(expected, f);
    } else if (birth) {
      f = restartFilter(c, *birth, best_kinematics, model);
    }
    updateShape(c, m, birth, track, scan.state, model, f);
    track.log_class[i] +=
        pair.log_class_evidence[i] + model.params.kinematic_exponent * logSpeed(c, f, model.params);
  }
  faceTheWay(model, track);
  if (m.base_z) scalarUpdate(*m.base_z, track.base_z);
  const double shape = look ? rememberEvidence(*look, scan, track) : 0;
  updateSizes(m, axisOf(model, track), model, track);
  clampClasses(model.params.class_epsilon, track.log_class);
  phantomHit(m, shape, pair.phantom, scan, row.detection, model, track);
  decideClass(model, pair.nis[static_cast<std::size_t>(best)] > surprisingNis(axes_seen), track);
  return track;
}

Track missTrack(Track predicted, const TrackLikelihoods& row, const MeasurementScan& scan,
                const FilterModel& model) {
  Track track = std::move(predicted);
  if (row.in_view) track.last_in_view = scan.state.stamp;
  if (row.detection <= 0 || model.params.existence_decay > 0) return track;
  const double r = track.existence;
  track.existence = r * (1 - row.seen) / (1 - r * row.seen);
  phantomMiss(scan, row.detection, track);
  if (scan.model->evidenceMemory()) track.missed += row.detection;
  if (const auto look = missedLook(track, scan, row.detection_by_class, row.visible)) {
    const RepeatedEvidence evidence(track, *look, scan, model.params.class_epsilon);
    for (std::size_t j = 0; j < track.log_class.size(); ++j)
      track.log_class[j] += evidence.added(j);
    rememberEvidence(*look, scan, track);
  } else {  // missed detections of one object are correlated, as its labels are
    const double exponent = scan.model->detectionExponent();
    for (std::size_t j = 0; j < track.log_class.size(); ++j)
      track.log_class[j] += exponent * std::log1p(-row.detection_by_class[j]);
  }
  clampClasses(model.params.class_epsilon, track.log_class);
  decideClass(model, false, track);
  return track;
}

Track newTrack(const BirthLikelihood& births, std::size_t measurement, const MeasurementScan& scan,
               std::uint64_t scan_index, const FilterModel& model) {
  const Measurement& m = scan.measurements[measurement];
  Track track;
  track.id = birthId(scan_index, measurement);
  track.history = extendHistory(0, scan_index, measurement);
  track.birth = track.stamp = track.last_in_view = scan.state.stamp;
  track.last_hit[modalityIndex(scan.modality)] = scan.state.stamp;
  track.hits[modalityIndex(scan.modality)] = 1;
  track.existence = std::min(births.existence, model.params.existence_max);
  track.phantom = births.phantom;
  track.log_class = births.log_class;
  for (ClassId j = 0; j < model.classes.size(); ++j) {
    const ObjectClass& c = model.classes[j];
    const auto birth = scan.model->birth(m, j, scan.state);
    if (birth) {
      const bool two = hasTwoSpeeds(c, track.log_class[static_cast<std::size_t>(j)], m, model);
      track.bank.push_back(startFilter(c, *birth, model, two));
    } else {
      track.bank.emplace_back();
      track.log_class[static_cast<std::size_t>(j)] = kMinusInfinity;
      track.existence = 0;  // no valid state
    }
    if (birth && m.radial_speed) {
      ClassFilter& f = track.bank.back();
      track.log_class[static_cast<std::size_t>(j)] += logRadialSpeed(c, f, *m.radial_speed);
      moveBy(*m.radial_speed, c, std::nullopt, model, f);
      settleSpeeds(c, f);
    }
    if (birth && m.heading && c.motion->has_heading)
      useHeading(*m.heading, model.params, track.bank.back());
  }
  if (m.heading) updateBodyHeading(*m.heading, model.params, track);
  track.base_z = {scan.state.ego.T_world_ego.translation().z(), 1};
  if (m.base_z) scalarUpdate(*m.base_z, track.base_z);
  rememberBirth(m, scan, model, track);
  startSizes(model, track);
  updateSizes(m, axisOf(model, track), model, track);
  clampClasses(model.params.class_epsilon, track.log_class);
  return track;
}

}  // namespace perception
