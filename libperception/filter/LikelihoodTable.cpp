#include "libperception/filter/LikelihoodTable.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/Angle.h"
#include "libperception/core/LogMath.h"
#include "libperception/filter/AssignmentPrior.h"
#include "libperception/filter/Gating.h"
#include "libperception/filter/Linearisation.h"
#include "libperception/filter/MotionModels.h"
#include "libperception/filter/PairDensity.h"
#include "libperception/filter/Parallel.h"

namespace perception {
namespace {

constexpr double kMaxDetection = 0.999;  // P_D = 1 would make one miss a proof
/// Share of the track's directions that nothing nearer hides.
double visibilityOf(const Track& track, const MeasurementScan& scan, const FilterModel& model) {
  if (!scan.horizon) return 1;
  const auto c = static_cast<std::size_t>(track.likeliestClass());
  const Vector2 d = track.bank[c].x.head<2>() - scan.state.T_world_sensor.translation().head<2>();
  const double range = d.norm();
  const double radius = 0.25 * (track.bank[c].extent.length + track.bank[c].extent.width);
  if (range <= radius) return 1;
  const double bearing = std::atan2(d.y(), d.x()), half = std::asin(radius / range);
  return scan.horizon->visibility(bearing - half, bearing + half, range - radius,
                                  model.params.hidden_tolerance);
}

/// What one track after the other needs again.
struct Scratch {
  std::vector<std::size_t> near;
  std::vector<Kinematics> kinematics;
  std::vector<Extent> extents;
  std::vector<AxisPrediction> predictions;
  std::vector<AxisBounds> bounds;
  std::vector<ExpectedAxes> expected;  // by class; of filters without modes
  std::vector<double> log_detection;   // by class
  std::vector<double> mixture;
  std::vector<double> with_region;
  PairLikelihood pair;
};

/// One class filter against one measurement; `log_region`: by how much the track's last region
/// makes it likelier, where there is one.
Density filterDensity(const Track& track, std::size_t filter, const Measurement& m,
                      const AxisList& axes, const MeasurementScan& scan, const FilterModel& model,
                      const RegionSeen* region, const Scratch& scratch, double& log_region) {
  const ClassFilter& f = track.bank[filter];
  const AxisPrediction& prediction = scratch.predictions[filter];
  if (f.modes.empty() && !region)
    return scratch.expected[filter].densityOf(prediction, m, axes, scan.model->axes());
  const auto innovation = innovationOf(f, scratch.kinematics[filter], prediction, m, *scan.model);
  const Density density = densityOf(innovation, f);
  if (region) {
    const auto expected = withRegion(innovation, *region, m, scan, model);
    log_region = densityOf(expected, f).log_density - density.log_density;
  }
  return density;
}

/// Fills scratch.pair; returns by how much its least NIS exceeds the gate.
double pairLikelihood(const Track& track, const std::vector<double>& detection_by_class,
                      std::size_t k, const AxisList& axes, const MeasurementScan& scan,
                      const FilterModel& model, double gate, Scratch& scratch) {
  const Measurement& m = scan.measurements[k];
  const std::size_t classes = track.bank.size();
  PairLikelihood& pair = scratch.pair;
  pair.measurement = k;
  pair.log_prior = 0;
  pair.log_by_class.assign(classes, kMinusInfinity);
  pair.log_class_evidence.assign(classes, kMinusInfinity);
  pair.nis.assign(classes, std::numeric_limits<double>::infinity());
  double min_excess = std::numeric_limits<double>::infinity();
  auto& mixture = scratch.mixture;
  mixture.assign(classes, kMinusInfinity);
  const RegionSeen* region = regionOf(track, scan, model);
  auto& with_region = scratch.with_region;
  with_region.assign(region ? classes : 0, kMinusInfinity);
  double log_region = 0;
  const double label_exponent = scan.model->labelExponent();
  const double detection_exponent = scan.model->detectionExponent();
  Density density;
  bool seen = false;  // a decided class: one filter stands for all
  for (std::size_t j = 0; j < classes; ++j) {
    const double detection = detection_by_class[j];
    const std::size_t filter = track.filterOf(j);
    if (!scratch.predictions[filter].defined || detection <= 0) continue;
    const ClassFilter& f = track.bank[filter];
    if (track.sure < 0 || !seen) {
      density = filterDensity(track, filter, m, axes, scan, model, region, scratch, log_region);
      seen = true;
    }
    if (density.log_density == kMinusInfinity) continue;
    const double nis = density.nis, log_density = density.log_density;
    const double label = logLabelOf(*scan.model, m, static_cast<ClassId>(j));
    const double label_and_score = logLabelAndScore(*scan.model, m, static_cast<ClassId>(j));
    const double heading = m.heading && f.oriented ? logHeadingRatio(*m.heading, f.x[3], f.P(3, 3),
                                                                     model.params.heading)
                                                   : 0;
    pair.nis[j] = nis;
    // The heading tells objects apart, but not classes: people have one, too, that no filter keeps.
    pair.log_by_class[j] = log_density + label_and_score + scratch.log_detection[j] + heading;
    pair.log_class_evidence[j] = model.params.kinematic_exponent * log_density +
                                 label_exponent * label +
                                 detection_exponent * scratch.log_detection[j];
    mixture[j] = track.log_class[j] + pair.log_by_class[j];
    if (region) with_region[j] = mixture[j] + log_region;
    min_excess = std::min(min_excess, nis - gate);
  }
  pair.log_likelihood = logSumExp(mixture);
  if (pair.log_likelihood == kMinusInfinity) return min_excess;
  if (region) pair.log_prior = logSumExp(with_region) - pair.log_likelihood;
  if (model.params.shape_prior) pair.log_prior += logShape(track, m);
  return min_excess;
}

TrackLikelihoods trackLikelihoods(const Track& track, const MeasurementScan& scan,
                                  const FilterModel& model, const Gates& gates) {
  const std::size_t classes = track.bank.size();
  thread_local Scratch scratch;
  TrackLikelihoods row;
  const Surroundings around(track);
  // Out of view: the scan says nothing of it.
  if (!scan.model->mayDetect(around.centre, around.spread + 2 * around.size + 1, scan.state)) {
    row.detection_by_class.assign(classes, 0);
    return row;
  }
  auto& near = scratch.near;
  near.clear();
  for (std::size_t k = 0; k < scan.measurements.size(); ++k) {
    if (around.mayBeNear(scan.measurements[k])) near.push_back(k);
  }
  auto& kinematics = scratch.kinematics;
  kinematics.resize(classes);
  for (std::size_t j = 0; j < classes; ++j) {
    const std::size_t filter = track.filterOf(j);
    kinematics[j] =
        filter == j || j == 0
            ? kinematicsOf(model.classes[static_cast<ClassId>(filter)], track.bank[filter])
            : kinematics[0];
  }
  const double visibility =
      std::max(visibilityOf(track, scan, model), model.params.hidden_detection);
  row.detection_by_class.resize(classes);
  for (std::size_t j = 0; j < classes; ++j) {
    const auto detection = [&](double visible) {
      return std::min(kMaxDetection,
                      scan.model->detectionProbability(static_cast<ClassId>(j), kinematics[j],
                                                       track.bank[track.filterOf(j)].extent,
                                                       scan.state, visible));
    };
    row.detection_by_class[j] = detection(visibility);
    if (row.detection_by_class[j] > 0) {
      row.detection += std::exp(track.log_class[j]) * row.detection_by_class[j];
      row.in_view = true;
    } else if (!row.in_view && visibility < 1) {
      row.in_view = detection(1) > 0;
    }
  }
  if (near.empty() || row.detection <= 0) return row;
  auto& extents = scratch.extents;
  auto& predictions = scratch.predictions;
  auto& bounds = scratch.bounds;
  extents.resize(classes);
  predictions.resize(classes);
  for (AxisPrediction& p : predictions) {  // models leave alone what they have nothing to say of
    p.defined = false;
    p.R_model.resize(0, 0);
  }
  bounds.clear();
  scratch.expected.resize(classes);
  scratch.log_detection.resize(classes);
  for (std::size_t j = 0; j < classes; ++j)
    scratch.log_detection[j] = std::log(row.detection_by_class[j]);
  for (std::size_t j = 0; j < classes; ++j) extents[j] = track.bank[track.filterOf(j)].extent;
  scan.model->predict(kinematics.data(), extents.data(), classes, scan.state, predictions.data());
  for (std::size_t j = 0; j < classes; ++j) {
    if (track.filterOf(j) != j) continue;
    lineariseAlongAspect(model.classes[static_cast<ClassId>(j)], track.bank[j], kinematics[j],
                         *scan.model, scan.state, predictions[j]);
    bounds.emplace_back(track.bank[j], kinematics[j], predictions[j]);
    if (predictions[j].defined && track.bank[j].modes.empty())
      scratch.expected[j].set(track.bank[j], kinematics[j], predictions[j]);
  }
  const auto& kinds = scan.model->axes();
  row.pairs.reserve(near.size());
  for (const std::size_t k : near) {
    const Measurement& m = scan.measurements[k];
    const AxisList axes(m, kinds.size());
    const double gate = gates.quantile[static_cast<std::size_t>(axes.count)];
    if (std::all_of(bounds.begin(), bounds.end(),
                    [&](const AxisBounds& b) { return b.exclude(m, kinds, gate); }))
      continue;
    if (!coarselyNear(track, m)) continue;
    const double excess =
        pairLikelihood(track, row.detection_by_class, k, axes, scan, model, gate, scratch);
    if (excess <= 0 && scratch.pair.log_likelihood > kMinusInfinity)
      row.pairs.push_back(scratch.pair);
  }
  if (!row.pairs.empty()) row.predictions = predictions;
  return row;
}

NewLikelihood newLikelihood(const Measurement& m, const MeasurementScan& scan,
                            const FilterModel& model) {
  const int classes = model.classes.size();
  NewLikelihood result;
  result.log_class.assign(static_cast<std::size_t>(classes), kMinusInfinity);
  for (ClassId j = 0; j < classes; ++j) {
    result.log_class[static_cast<std::size_t>(j)] = std::log(model.classes[j].prior) +
                                                    logLabelAndScore(*scan.model, m, j) +
                                                    scan.model->logBirthDensity(m, j, scan.state);
  }
  result.log_birth = logNormalise(result.log_class);
  result.log_clutter =
      scan.model->logClutterDensity(m, scan.state) + logClutterLabelAndScore(*scan.model, m);
  if (model.params.shape_prior) weighShape(m, scan.state, model, result);
  result.log_new = logAddExp(result.log_birth, result.log_clutter);
  result.existence =
      result.log_new > kMinusInfinity ? std::exp(result.log_birth - result.log_new) : 0;
  if (model.params.sampled_births && result.existence > 0) result.existence = 1;
  return result;
}

}  // namespace

LikelihoodTable likelihoodTable(const std::vector<Track>& predicted,
                                const std::vector<char>& touched, const MeasurementScan& scan,
                                const FilterModel& model) {
  const Gates& gates = Gates::of(model.params.gate_probability);
  LikelihoodTable table;
  table.tracks.resize(predicted.size());
  table.news.resize(scan.measurements.size());
  parallelFor(predicted.size(), [&](std::size_t i) {
    if (touched[i]) table.tracks[i] = trackLikelihoods(predicted[i], scan, model, gates);
  });
  parallelFor(scan.measurements.size(), [&](std::size_t k) {
    table.news[k] = newLikelihood(scan.measurements[k], scan, model);
  });
  return table;
}

LikelihoodTable likelihoodTable(const std::vector<Track>& predicted, const MeasurementScan& scan,
                                const FilterModel& model) {
  return likelihoodTable(predicted, std::vector<char>(predicted.size(), 1), scan, model);
}

}  // namespace perception
