#include "libperception/filter/likelihood/LikelihoodTable.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Angle.h"
#include "libperception/core/math/LogMath.h"
#include "libperception/core/system/Parallel.h"
#include "libperception/filter/likelihood/AssignmentPrior.h"
#include "libperception/filter/likelihood/Gating.h"
#include "libperception/filter/likelihood/LikelihoodRow.h"
#include "libperception/filter/likelihood/Linearization.h"
#include "libperception/filter/likelihood/PairDensity.h"
#include "libperception/filter/likelihood/PhantomOdds.h"
#include "libperception/filter/state/ClassFilterMotion.h"

namespace perception {
namespace {

/// Buffers reused from track to track.
struct Scratch {
  std::vector<std::size_t> near;
  std::vector<Kinematics> kinematics;
  std::vector<Extent> extents;
  std::vector<AxisPrediction> predictions;
  std::vector<AxisBounds> bounds;
  std::vector<ExpectedAxes> expected;  // by class; of filters without modes
  std::vector<double> log_detection;   // by class
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
double pairLikelihood(const Track& track, const ClassValues& detection_by_class, std::size_t k,
                      const AxisList& axes, const ScanTerms& terms, double gate, Scratch& scratch) {
  const Measurement& m = terms.scan.measurements[k];
  PairLikelihood& pair = scratch.pair;
  PairTerms sum(track, detection_by_class, k, terms, pair);
  double min_excess = std::numeric_limits<double>::infinity();
  const RegionSeen* region = regionOf(track, terms.scan, terms.model);
  ClassValues with_region;
  with_region.assign(region ? track.bank.size() : 0, kMinusInfinity);
  double log_region = 0;
  Density density;
  bool seen = false;  // with a decided class, one filter is used for all
  for (std::size_t j = 0; j < track.bank.size(); ++j) {
    const std::size_t filter = track.filterOf(j);
    if (!scratch.predictions[filter].defined || detection_by_class[j] <= 0) continue;
    if (track.decided_class < 0 || !seen) {
      density = filterDensity(track, filter, m, axes, terms.scan, terms.model, region, scratch,
                              log_region);
      seen = true;
    }
    if (density.log_density == kMinusInfinity) continue;
    sum.add(j, density, scratch.log_detection[j]);
    if (region) with_region[j] = sum.mixture()[j] + log_region;
    min_excess = std::min(min_excess, density.nis - gate);
  }
  sum.finish();
  if (region && pair.log_likelihood > kMinusInfinity)
    pair.log_prior += logSumExp(with_region) - pair.log_likelihood;
  return min_excess;
}

/// Kinematics of each class filter; with a decided class, shared.
void setKinematics(const Track& track, const FilterModel& model, Scratch& scratch) {
  const std::size_t classes = track.bank.size();
  auto& kinematics = scratch.kinematics;
  kinematics.resize(classes);
  for (std::size_t j = 0; j < classes; ++j) {
    const std::size_t filter = track.filterOf(j);
    kinematics[j] =
        filter == j || j == 0
            ? kinematicsOf(model.classes[static_cast<ClassId>(filter)], track.bank[filter])
            : kinematics[0];
  }
}

/// P_D by class and of the mixture (method.md (25)), and whether the track is in view at all.
void setDetection(const Track& track, const ScanTerms& terms, const Scratch& scratch,
                  TrackLikelihoods& row) {
  const MeasurementScan& scan = terms.scan;
  const double visibility = visibilityOf(track, scan, terms.model);
  row.visible = visibility;
  row.detection_by_class.resize(track.bank.size());
  for (std::size_t j = 0; j < track.bank.size(); ++j) {
    const auto detection = [&](double visible) {
      return std::min(kMaxDetection,
                      scan.model->detectionProbability(
                          static_cast<ClassId>(j), scratch.kinematics[j],
                          track.bank[track.filterOf(j)].extent, scan.state, visible));
    };
    row.detection_by_class[j] = detection(visibility);
    if (row.detection_by_class[j] > 0) {
      row.detection += std::exp(track.log_class[j]) * row.detection_by_class[j];
      row.in_view = true;
    } else if (!row.in_view && visibility < 1) {
      row.in_view = detection(1) > 0;
    }
  }
}

/// h and its derivatives for the whole bank, linearized along the aspect (method.md 4.6), and the
/// bounds that exclude measurements axis by axis.
void predictBank(const Track& track, const ScanTerms& terms, const TrackLikelihoods& row,
                 Scratch& scratch) {
  const MeasurementScan& scan = terms.scan;
  const std::size_t classes = track.bank.size();
  auto& extents = scratch.extents;
  auto& predictions = scratch.predictions;
  extents.resize(classes);
  predictions.resize(classes);
  for (AxisPrediction& p : predictions) {  // a model may leave an undefined prediction untouched
    p.defined = false;
    p.R_model.resize(0, 0);
  }
  scratch.bounds.clear();
  scratch.expected.resize(classes);
  scratch.log_detection.resize(classes);
  for (std::size_t j = 0; j < classes; ++j)
    scratch.log_detection[j] = std::log(row.detection_by_class[j]);
  for (std::size_t j = 0; j < classes; ++j) extents[j] = track.bank[track.filterOf(j)].extent;
  scan.model->predict(scratch.kinematics.data(), extents.data(), classes, scan.state,
                      predictions.data());
  for (std::size_t j = 0; j < classes; ++j) {
    if (track.filterOf(j) != j) continue;
    linearizeAlongAspect(terms.model.classes[static_cast<ClassId>(j)], track.bank[j],
                         scratch.kinematics[j], *scan.model, scan.state, predictions[j]);
    scan.model->addClassNoise(static_cast<ClassId>(j), scratch.kinematics[j], scan.state,
                              predictions[j]);
    scratch.bounds.emplace_back(track.bank[j], scratch.kinematics[j], predictions[j]);
    if (predictions[j].defined && track.bank[j].modes.empty())
      scratch.expected[j].set(track.bank[j], scratch.kinematics[j], predictions[j]);
  }
}

/// The pairs inside the gate.
void setPairs(const Track& track, const ScanTerms& terms, Scratch& scratch, TrackLikelihoods& row) {
  const auto& kinds = terms.scan.model->axes();
  for (const std::size_t k : scratch.near) {
    const Measurement& m = terms.scan.measurements[k];
    const AxisList axes(m, kinds.size());
    const double gate = terms.gates.quantile[static_cast<std::size_t>(axes.count)];
    if (std::all_of(scratch.bounds.begin(), scratch.bounds.end(),
                    [&](const AxisBounds& b) { return b.exclude(m, kinds, gate); }))
      continue;
    if (!coarseGate(track, m)) continue;
    const double excess =
        pairLikelihood(track, row.detection_by_class, k, axes, terms, gate, scratch);
    if (excess <= 0 && scratch.pair.log_likelihood > kMinusInfinity)
      row.pairs.push_back(scratch.pair);
  }
}

/// Without phantoms in wakes.
TrackLikelihoods objectLikelihoods(const Track& track, const ScanTerms& terms) {
  const MeasurementScan& scan = terms.scan;
  thread_local Scratch scratch;
  TrackLikelihoods row;
  const BoundingDisc around(track);
  // Out of view: no evidence.
  if (!scan.model->mayDetect(around.center, around.spread + 2 * around.size + 1, scan.state)) {
    row.detection_by_class.assign(track.bank.size(), 0);
    return row;
  }
  scratch.near.clear();
  for (std::size_t k = 0; k < scan.measurements.size(); ++k) {
    if (around.mayBeNear(scan.measurements[k])) scratch.near.push_back(k);
  }
  if (takesPositionRow(track, terms)) {
    positionRow(track, scratch.near, terms, row);
    return row;
  }
  setKinematics(track, terms.model, scratch);
  setDetection(track, terms, scratch, row);
  if (scratch.near.empty() || row.detection <= 0) return row;
  predictBank(track, terms, row, scratch);
  setPairs(track, terms, scratch, row);
  if (!row.pairs.empty()) row.predictions = scratch.predictions;
  return row;
}

TrackLikelihoods trackLikelihoods(const Track& track, const ScanTerms& terms) {
  TrackLikelihoods row = objectLikelihoods(track, terms);
  row.seen = row.detection;
  if (track.phantom <= 0 || row.detection <= 0) return row;
  row.seen = detectionWithPhantom(track, terms.scan, row.detection);
  const double log_ratio = std::log(row.seen / row.detection);
  for (PairLikelihood& pair : row.pairs) pair.log_prior += log_ratio;
  return row;
}

/// log of P_D over its mean by the class prior where looks repeat, else 0: the detection is a look,
/// too, and the rate of births is that of first detections.
ClassValues logFirstDetected(const Measurement& m, const ScanTerms& terms) {
  ClassValues result;
  result.assign(terms.log_prior.size(), 0);
  if (!terms.scan.model->lookMemory()) return result;
  const ClassValues detection = detectionAtBirth(m, terms.scan, terms.model);
  double mean = 0;
  for (std::size_t j = 0; j < detection.size(); ++j)
    mean += std::exp(terms.log_prior[j]) * detection[j];
  if (mean <= 0) return result;
  for (std::size_t j = 0; j < detection.size(); ++j)
    result[j] = std::log(std::max(detection[j], 1e-6) / mean);
  return result;
}

BirthLikelihood birthLikelihood(std::size_t k, const ScanTerms& terms) {
  const MeasurementScan& scan = terms.scan;
  const FilterModel& model = terms.model;
  const Measurement& m = scan.measurements[k];
  const int classes = model.classes.size();
  const auto log_detected = logFirstDetected(m, terms);
  BirthLikelihood result;
  result.log_class.assign(static_cast<std::size_t>(classes), kMinusInfinity);
  for (ClassId j = 0; j < classes; ++j) {
    result.log_class[static_cast<std::size_t>(j)] =
        terms.log_prior[static_cast<std::size_t>(j)] + log_detected[static_cast<std::size_t>(j)] +
        terms.labelAndScore(k, static_cast<std::size_t>(j)) +
        scan.model->logBirthDensity(m, j, scan.state);
  }
  result.log_birth = logNormalize(result.log_class);
  result.log_clutter =
      scan.model->logClutterDensity(m, scan.state) + logClutterLabelAndScore(*scan.model, m);
  if (model.params.shape_prior) weighShape(m, scan.state, model, result);
  result.log_new = logAddExp(result.log_birth, result.log_clutter);
  double log_cause = result.log_birth;
  const double over_clutter = phantomDensity(m.position, scan), over_birth = phantomOdds(m);
  if (over_clutter > 0 || over_birth > 0) {
    const double log_phantom = std::max(result.log_clutter + std::log(over_clutter),
                                        result.log_birth + std::log(over_birth));
    log_cause = logAddExp(result.log_birth, log_phantom);
    result.log_new = logAddExp(result.log_new, log_phantom);
    if (log_cause > kMinusInfinity) result.phantom = std::exp(log_phantom - log_cause);
  }
  result.existence = result.log_new > kMinusInfinity ? std::exp(log_cause - result.log_new) : 0;
  if (model.params.sampled_births && result.existence > 0) result.existence = 1;
  return result;
}

}  // namespace

LikelihoodTable likelihoodTable(const std::vector<Track>& predicted,
                                const std::vector<char>& touched, const MeasurementScan& scan,
                                const FilterModel& model) {
  const ScanTerms terms(scan, model);
  LikelihoodTable table;
  table.tracks.resize(predicted.size());
  table.births.resize(scan.measurements.size());
  parallelFor(predicted.size(), [&](std::size_t i) {
    if (touched[i]) table.tracks[i] = trackLikelihoods(predicted[i], terms);
  });
  parallelFor(scan.measurements.size(),
              [&](std::size_t k) { table.births[k] = birthLikelihood(k, terms); });
  for (TrackLikelihoods& row : table.tracks)
    for (PairLikelihood& pair : row.pairs) pair.phantom = table.births[pair.measurement].phantom;
  return table;
}

LikelihoodTable likelihoodTable(const std::vector<Track>& predicted, const MeasurementScan& scan,
                                const FilterModel& model) {
  return likelihoodTable(predicted, std::vector<char>(predicted.size(), 1), scan, model);
}

}  // namespace perception
