#include "libperception/filter/likelihood/LikelihoodRow.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/math/LogMath.h"
#include "libperception/filter/likelihood/AssignmentPrior.h"
#include "libperception/filter/likelihood/Gating.h"
#include "libperception/filter/state/ClassFilterMotion.h"

namespace perception {
namespace {

constexpr AxisMask kPlaceSeen = 3;       // x and y
constexpr double kStartsAndStops = 0.1;  // [1/s] rate at which vehicles do either (assumed)

/// Innovation covariance of a class filter without R of the measurement.
struct ExpectedPlace {
  double x, y, xx, xy, yy;
};

double shareNotHidden(const Track& track, const MeasurementScan& scan, const FilterModel& model) {
  if (!scan.occlusion) return 1;
  const auto c = static_cast<std::size_t>(track.likeliestClass());
  const Vector2 d = track.bank[c].x.head<2>() - scan.state.T_world_sensor.translation().head<2>();
  const double range = d.norm();
  const double radius = 0.25 * (track.bank[c].extent.length + track.bank[c].extent.width);
  if (range <= radius) return 1;
  const double bearing = std::atan2(d.y(), d.x()), half = std::asin(radius / range);
  return scan.occlusion->visibility(bearing - half, bearing + half, range - radius,
                                    model.params.occlusion_tolerance);
}

/// P_D by class; false: nothing can be detected.
bool setDetection(const Track& track, const std::vector<Vector2>& places, const ScanTerms& terms,
                  TrackLikelihoods& row) {
  auto& detection = row.detection_by_class;
  detection.resize(places.size());
  terms.place()->placeDetection(places.data(), places.size(), terms.scan.state, detection.begin());
  row.in_view = std::any_of(detection.begin(), detection.end(), [](double d) { return d > 0; });
  if (!row.in_view) return false;
  const double visibility = visibilityOf(track, terms.scan, terms.model);
  row.visible = visibility;
  for (std::size_t j = 0; j < places.size(); ++j) {
    detection[j] = std::min(kMaxDetection, detection[j] * visibility);
    if (detection[j] > 0) row.detection += std::exp(track.log_class[j]) * detection[j];
  }
  return row.detection > 0;
}

/// N(z - h; 0, S) without its logarithm.
struct PlaceResidual {
  double nis = std::numeric_limits<double>::infinity(), determinant = 0;
};

PlaceResidual residualOf(const ExpectedPlace& e, const Measurement& m) {
  const double xx = e.xx + m.R(0, 0), xy = e.xy + m.R(1, 0), yy = e.yy + m.R(1, 1);
  const double l = xy / xx, rest = yy - l * xy;
  if (!(xx > 0) || !(rest > 0)) return {};
  const double dx = m.z[0] - e.x, dy = (m.z[1] - e.y) - l * dx;
  return {dx * dx / xx + dy * dy / rest, xx * rest};
}

}  // namespace

ScanTerms::ScanTerms(const MeasurementScan& s, const FilterModel& m)
    : scan(s),
      model(m),
      gates(Gates::of(m.params.gate_probability)),
      label_exponent(s.model->labelExponent()),
      detection_exponent(s.model->lookMemory() ? 0 : s.model->detectionExponent()),
      kinematic_exponent_(m.params.kinematic_exponent * s.model->innovationShare()),
      alone_kinematic_exponent_(m.params.kinematic_exponent * s.model->aloneInnovationShare()),
      classes_(static_cast<std::size_t>(m.classes.size())) {
  for (const ObjectClass& c : model.classes.classes) log_prior.push_back(std::log(c.prior));
  labels_.reserve(scan.measurements.size() * classes_);
  for (const Measurement& z : scan.measurements) {
    for (ClassId j = 0; j < model.classes.size(); ++j)
      labels_.push_back({logLabelOf(*scan.model, z, j), logLabelAndScore(*scan.model, z, j)});
  }
  const auto& all = model.classes.classes;
  const auto still =
      std::find_if(all.begin(), all.end(), [](const ObjectClass& c) { return !c.motion->moves; });
  if (still != all.end()) still_ = static_cast<ClassId>(still - all.begin());
  const bool place = std::all_of(scan.measurements.begin(), scan.measurements.end(),
                                 [](const Measurement& z) { return z.seen == kPlaceSeen; });
  if (place && model.params.region_memory <= 0) place_ = scan.model->positionOnly();
}

double visibilityOf(const Track& track, const MeasurementScan& scan, const FilterModel& model) {
  return std::max(shareNotHidden(track, scan, model), model.params.occluded_detection);
}

PairTerms::PairTerms(const Track& track, const ClassValues& detection, std::size_t measurement,
                     const ScanTerms& terms, PairLikelihood& pair)
    : track_(track),
      terms_(terms),
      m_(terms.scan.measurements[measurement]),
      pair_(pair),
      kinematic_exponent_(terms.kinematicExponent(track)) {
  if (auto look = weighedLookOf(track, m_, terms.scan, detection, terms.model.classes))
    evidence_.emplace(track, std::move(*look), terms.scan, terms.model.params.class_epsilon);
  const std::size_t classes = track.bank.size();
  pair.measurement = measurement;
  pair.log_prior = 0;
  pair.log_by_class.assign(classes, kMinusInfinity);
  pair.log_class_evidence.assign(classes, kMinusInfinity);
  pair.nis.assign(classes, std::numeric_limits<double>::infinity());
  mixture_.assign(classes, kMinusInfinity);
  log_density_.assign(classes, kMinusInfinity);
}

void PairTerms::add(std::size_t j, const Density& density, double log_detection) {
  const ClassFilter& f = track_.bank[track_.filterOf(j)];
  const double heading = m_.heading && f.oriented ? logHeadingRatio(*m_.heading, f.x[3], f.P(3, 3),
                                                                    terms_.model.params.heading)
                                                  : 0;
  const std::size_t k = pair_.measurement;
  pair_.nis[j] = density.nis;
  // A measured heading is evidence of the object, not of the class: people also have a heading,
  // which their filters do not estimate.
  pair_.log_by_class[j] =
      density.log_density + terms_.labelAndScore(k, j) + log_detection + heading;
  log_density_[j] = density.log_density;
  pair_.log_class_evidence[j] =
      kinematic_exponent_ * density.log_density +
      (evidence_ ? evidence_->added(j) : terms_.label_exponent * terms_.label(k, j)) +
      terms_.detection_exponent * log_detection;
  mixture_[j] = track_.log_class[j] + pair_.log_by_class[j];
}

namespace {

/// One of two motions of an object, as evidence of its class alone.
struct TwoMotions {
  double first;  ///< probability of the first one before the measurement

  /// `was` [0, 1], drawn to what is usual over `dt` [s].
  TwoMotions(double was, double usual, double dt) {
    constexpr double kLeast = 1e-6;
    const double same = std::exp(-2 * kStartsAndStops * dt);
    first = std::clamp(usual + (was - usual) * same, kLeast, 1 - kLeast);
  }
  /// Of the mixture's log density over that of the second motion, without overflow; `d`: log
  /// density of the first over it.
  double gain(double d) const {
    return d > 0 ? d + std::log(first + (1 - first) * std::exp(-d))
                 : std::log(first * std::exp(d) + (1 - first));
  }
  double posterior(double d) const { return 1 / (1 + (1 - first) / first * std::exp(-d)); }
};

}  // namespace

/// How well the velocity by the class's filter agrees with that of the sensor's vehicle at the
/// object's place. In the vehicle's own way no thing goes along: a long one would be driven over,
/// so that what goes along there is a vehicle ahead.
double PairTerms::logGoesAlong(std::size_t j) const {
  constexpr double kOwnWay = 2, kSlack = 0.3;  // [m] to either side, [m/s] (assumed)
  const auto filter = track_.filterOf(j);
  const ClassFilter& f = track_.bank[filter];
  const Vector4 q = kinematicsOf(terms_.model.classes[static_cast<ClassId>(filter)], f).q.head<4>();
  const EgoState& ego = terms_.scan.state.ego;
  const Vector2 arm = q.head<2>() - ego.T_world_ego.translation().head<2>();
  const double aside = ego.velocity.x() * arm.y() - ego.velocity.y() * arm.x();  // [m^2/s]
  if (std::abs(aside) < kOwnWay * ego.velocity.norm()) return kMinusInfinity;
  const Vector2 along = ego.velocity + ego.yaw_rate * Vector2(-arm.y(), arm.x());
  const double variance = f.oriented ? f.P(2, 2) : 0.5 * (f.P(2, 2) + f.P(3, 3));
  return -0.5 * (q.tail<2>() - along).squaredNorm() / (variance + kSlack * kSlack);
}

void PairTerms::weighMotions() {
  pair_.stands = track_.stands, pair_.goes_along = track_.goes_along;
  if (terms_.still() < 0 || !m_.view) return;
  const auto thing = static_cast<std::size_t>(terms_.still());
  const double still = log_density_[thing];
  if (still == kMinusInfinity) return;
  const Stamp seen = *std::max_element(track_.last_hit.begin(), track_.last_hit.end());
  const double dt = std::max(0.0, terms_.scan.state.stamp - seen);
  const TwoMotions stands(track_.stands, 0.5, dt), goes(track_.goes_along, kGoesAlong, dt);
  double moving = kMinusInfinity;  // of the vehicle that fits best
  double along = kMinusInfinity;   // of what moves as the vehicle of the sensor
  for (std::size_t j = 0; j < log_density_.size(); ++j) {
    const double own = log_density_[j];
    if (own == kMinusInfinity || j == thing) continue;
    along = std::max(along, own + logGoesAlong(j));
    if (terms_.model.classes[static_cast<ClassId>(j)].shape != ObjectShape::kVehicle) continue;
    moving = std::max(moving, own);
    pair_.log_class_evidence[j] += kinematic_exponent_ * stands.gain(still - own);
  }
  if (moving > kMinusInfinity) pair_.stands = stands.posterior(still - moving);
  constexpr double kStands = 1;  // [m/s] of the sensor's vehicle
  if (along == kMinusInfinity || terms_.scan.state.ego.velocity.norm() < kStands) return;
  pair_.log_class_evidence[thing] += kinematic_exponent_ * goes.gain(along - still);
  pair_.goes_along = goes.posterior(along - still);
}

void PairTerms::finish() {
  weighMotions();
  pair_.log_likelihood = logSumExp(mixture_);
  if (pair_.log_likelihood > kMinusInfinity && terms_.model.params.shape_prior)
    pair_.log_prior += logShape(track_, m_);
}

bool takesPositionRow(const Track& track, const ScanTerms& terms) {
  return terms.place() && std::all_of(track.bank.begin(), track.bank.end(),
                                      [](const ClassFilter& f) { return f.modes.empty(); });
}

void positionRow(const Track& track, const std::vector<std::size_t>& near, const ScanTerms& terms,
                 TrackLikelihoods& row) {
  const std::size_t classes = track.bank.size();
  thread_local std::vector<Vector2> places;
  thread_local std::vector<ExpectedPlace> expected;
  thread_local std::vector<PlaceResidual> residuals;
  thread_local ClassValues log_detection;
  places.resize(classes);
  for (std::size_t j = 0; j < classes; ++j) places[j] = track.bank[track.filterOf(j)].x.head<2>();
  if (!setDetection(track, places, terms, row) || near.empty()) return;
  expected.resize(classes);
  for (std::size_t j = 0; j < classes; ++j) {
    const std::size_t filter = track.filterOf(j);
    const Matrix4& P = track.bank[filter].P;
    const Matrix2& noise = terms.place()->placeNoise(static_cast<ClassId>(filter));
    constexpr double kRegular = 1e-9;  // keeps S invertible for any R (method.md 4)
    expected[j] = {places[j].x(), places[j].y(), P(0, 0) + noise(0, 0) + kRegular,
                   P(1, 0) + noise(1, 0), P(1, 1) + noise(1, 1) + kRegular};
  }
  residuals.resize(classes);
  log_detection.resize(0);
  const double gate = terms.gates.quantile[2];
  for (const std::size_t k : near) {
    const Measurement& m = terms.scan.measurements[k];
    bool passes = false;
    for (std::size_t j = 0; j < classes; ++j) {
      if (row.detection_by_class[j] <= 0) continue;
      residuals[j] = residualOf(expected[j], m);
      passes = passes || residuals[j].nis <= gate;
    }
    if (!passes || !coarseGate(track, m)) continue;
    if (log_detection.empty()) {
      log_detection.resize(classes);
      for (std::size_t j = 0; j < classes; ++j)
        log_detection[j] = std::log(row.detection_by_class[j]);
    }
    if (row.pairs.empty()) row.pairs.reserve(2);  // most have no more
    PairLikelihood& pair = row.pairs.emplace_back();
    PairTerms sum(track, row.detection_by_class, k, terms, pair);
    for (std::size_t j = 0; j < classes; ++j) {
      if (row.detection_by_class[j] <= 0 || residuals[j].determinant <= 0) continue;
      constexpr double kTwoLogTwoPi = 2 * 1.8378770664093454836;
      const PlaceResidual& r = residuals[j];
      const double log_density = -0.5 * (r.nis + std::log(r.determinant) + kTwoLogTwoPi);
      sum.add(j, {log_density, r.nis}, log_detection[j]);
    }
    sum.finish();
    if (pair.log_likelihood == kMinusInfinity) row.pairs.pop_back();
  }
}

}  // namespace perception
