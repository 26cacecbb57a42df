#include "libperception/filter/LikelihoodTable.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include "libperception/filter/Parallel.h"

#include "libperception/core/Angle.h"
#include "libperception/core/Chi2.h"
#include "libperception/core/LogMath.h"
#include "libperception/filter/Linearisation.h"
#include "libperception/filter/MotionModels.h"

namespace perception {
namespace {

constexpr double kMaxDetection = 0.999;  // P_D = 1 would make one miss a proof
/// Before any matrix: pairs farther apart than this many standard deviations (plus 2 m of size)
/// cannot pass the gate.
constexpr double kCoarseGate = 6;
constexpr double kCoarseMargin = 2;  // [m]

struct Gates {
  explicit Gates(double probability) {
    for (int n = 1; n <= kMaxAxes; ++n)
      quantile[static_cast<std::size_t>(n)] = chi2Quantile(probability, n);
  }
  std::array<double, kMaxAxes + 1> quantile{};
};

bool coarselyNear(const Track& track, const Measurement& m) {
  double reach = 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t j = 0; j < track.bank.size(); ++j) {
    if (!track.live(static_cast<ClassId>(j))) continue;
    const ClassFilter& f = track.bank[j];
    const double sigma = std::sqrt(std::max(f.P(0, 0), f.P(1, 1))) + m.position_sigma;
    const double size = 0.5 * std::max(f.extent.length, f.extent.width);
    reach = std::max(reach, kCoarseGate * sigma + size + kCoarseMargin);
    nearest = std::min(nearest, (f.x.head<2>() - m.position).norm());
  }
  return nearest <= reach;
}

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

/// Log density of an innovation and its normalised square; of modes their mixture and the least.
struct Density {
  double log_density = kMinusInfinity;
  double nis = std::numeric_limits<double>::infinity();
};

Density gaussian(const AxisVector& y, const AxisMatrix& S) {
  Density out;
  const Eigen::LLT<AxisMatrix> llt(S);
  if (llt.info() != Eigen::Success) return out;
  const auto n = y.size();
  out.nis = llt.matrixL().solve(y).squaredNorm();
  double log_det = 0;
  for (Eigen::Index i = 0; i < n; ++i) log_det += 2 * std::log(llt.matrixLLT()(i, i));
  out.log_density = -0.5 * (out.nis + log_det + static_cast<double>(n) * std::log(kTwoPi));
  return out;
}

Density densityOf(const Innovation& innovation, const ClassFilter& filter) {
  if (filter.modes.empty()) return gaussian(innovation.y, innovation.S);
  Density out;
  for (const auto& mode : filter.modes) {
    const Density d =
        gaussian(innovation.residualOf(mode, filter), innovation.covarianceOf(mode.P));
    out.log_density = logAddExp(out.log_density, mode.log_probability + d.log_density);
    out.nis = std::min(out.nis, d.nis);
  }
  return out;
}

PairLikelihood pairLikelihood(const Track& track, const TrackLikelihoods& row,
                              const std::vector<Kinematics>& kinematics, std::size_t k,
                              const MeasurementScan& scan, const FilterModel& model,
                              double& min_excess, const Gates& gates) {
  const Measurement& m = scan.measurements[k];
  const std::size_t classes = track.bank.size();
  PairLikelihood pair;
  pair.measurement = k;
  pair.log_by_class.assign(classes, kMinusInfinity);
  pair.log_class_evidence.assign(classes, kMinusInfinity);
  pair.nis.assign(classes, std::numeric_limits<double>::infinity());
  min_excess = std::numeric_limits<double>::infinity();
  std::vector<double> mixture(classes, kMinusInfinity);
  const double label_exponent = scan.model->labelExponent();
  const double detection_exponent = scan.model->detectionExponent();
  Density density;
  Eigen::Index n = 0;
  bool seen = false;  // a decided class: one filter stands for all
  for (std::size_t j = 0; j < classes; ++j) {
    const double detection = row.detection_by_class[j];
    const std::size_t filter = track.filterOf(j);
    if (!row.predictions[filter].defined || detection <= 0) continue;
    if (track.sure < 0 || !seen) {
      const auto innovation = innovationOf(track.bank[filter], kinematics[filter],
                                           row.predictions[filter], m, *scan.model);
      n = innovation.y.size();
      density = densityOf(innovation, track.bank[filter]);
      seen = true;
    }
    if (density.log_density == kMinusInfinity) continue;
    const double nis = density.nis, log_density = density.log_density;
    const double label = logLabelOf(*scan.model, m, static_cast<ClassId>(j));
    const double label_and_score = logLabelAndScore(*scan.model, m, static_cast<ClassId>(j));
    const ClassFilter& f = track.bank[filter];
    const double heading = m.heading && f.oriented ? logHeadingRatio(*m.heading, f.x[3], f.P(3, 3),
                                                                     model.params.heading)
                                                   : 0;
    pair.nis[j] = nis;
    // The heading tells objects apart, but not classes: people have one, too, that no filter keeps.
    pair.log_by_class[j] = log_density + label_and_score + std::log(detection) + heading;
    pair.log_class_evidence[j] = model.params.kinematic_exponent * log_density +
                                 label_exponent * label + detection_exponent * std::log(detection);
    mixture[j] = track.log_class[j] + pair.log_by_class[j];
    min_excess = std::min(min_excess, nis - gates.quantile[static_cast<std::size_t>(n)]);
  }
  pair.log_likelihood = logSumExp(mixture);
  return pair;
}

TrackLikelihoods trackLikelihoods(const Track& track, const MeasurementScan& scan,
                                  const FilterModel& model, const Gates& gates) {
  const std::size_t classes = track.bank.size();
  TrackLikelihoods row;
  std::vector<Kinematics> kinematics(classes);
  std::vector<Extent> extents(classes);
  for (std::size_t j = 0; j < classes; ++j) {
    const std::size_t filter = track.filterOf(j);
    kinematics[j] =
        filter == j || j == 0
            ? kinematicsOf(model.classes[static_cast<ClassId>(filter)], track.bank[filter])
            : kinematics[0];
    extents[j] = track.bank[filter].extent;
  }
  row.predictions.resize(classes);
  scan.model->predict(kinematics.data(), extents.data(), classes, scan.state,
                      row.predictions.data());
  for (std::size_t j = 0; j < classes; ++j) {
    if (track.filterOf(j) != j) continue;
    lineariseAlongAspect(model.classes[static_cast<ClassId>(j)], track.bank[j], kinematics[j],
                         *scan.model, scan.state, row.predictions[j]);
  }
  const double visibility =
      std::max(visibilityOf(track, scan, model), model.params.hidden_detection);
  row.detection_by_class.resize(classes);
  for (std::size_t j = 0; j < classes; ++j) {
    const auto detection = [&](double visible) {
      return std::min(kMaxDetection,
                      scan.model->detectionProbability(static_cast<ClassId>(j), kinematics[j],
                                                       extents[j], scan.state, visible));
    };
    row.detection_by_class[j] = detection(visibility);
    row.detection += std::exp(track.log_class[j]) * row.detection_by_class[j];
    row.in_view = row.in_view || detection(1) > 0;
  }
  for (std::size_t k = 0; k < scan.measurements.size(); ++k) {
    if (!coarselyNear(track, scan.measurements[k])) continue;
    double excess = 0;
    auto pair = pairLikelihood(track, row, kinematics, k, scan, model, excess, gates);
    if (excess <= 0 && pair.log_likelihood > kMinusInfinity) row.pairs.push_back(std::move(pair));
  }
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
  result.log_new = logAddExp(result.log_birth, result.log_clutter);
  result.existence =
      result.log_new > kMinusInfinity ? std::exp(result.log_birth - result.log_new) : 0;
  if (model.params.sampled_births && result.existence > 0) result.existence = 1;
  return result;
}

}  // namespace

Innovation innovationOf(const ClassFilter& filter, const Kinematics& kinematics,
                        const AxisPrediction& prediction, const Measurement& m,
                        const MeasurementModel& model) {
  Innovation out;
  out.y = residual(model, m, prediction.h);
  const auto n = out.y.size();
  out.H.resize(n, 4);
  out.R.resize(n, n);
  auto& H_extent = out.H_extent;
  H_extent.resize(n, 2);
  std::array<Eigen::Index, kMaxAxes> axis{};
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < model.axes().size(); ++i) {
    if (m.seen >> i & 1) axis[static_cast<std::size_t>(row++)] = static_cast<Eigen::Index>(i);
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto a = axis[static_cast<std::size_t>(i)];
    out.H.row(i) = prediction.H_q.row(a) * kinematics.J;
    H_extent.row(i) = prediction.H_extent.row(a);
    for (Eigen::Index k = 0; k < n; ++k) {
      const auto b = axis[static_cast<std::size_t>(k)];
      out.R(i, k) = m.R(a, b) + (prediction.R_model.size() > 0 ? prediction.R_model(a, b) : 0);
    }
  }
  const Vector2 extent_variance(filter.extent.var_length, filter.extent.var_width);
  out.R += H_extent * extent_variance.asDiagonal() * H_extent.transpose();
  for (Eigen::Index i = 0; i < n; ++i)
    if (!(model.extentAxes() >> axis[static_cast<std::size_t>(i)] & 1)) H_extent.row(i).setZero();
  out.R.diagonal().array() += 1e-9;  // S stays invertible whatever the sensor says (SPEC 4)
  out.S = out.covarianceOf(filter.P);
  return out;
}

AxisVector Innovation::residualOf(const ModeFilter& mode, const ClassFilter& filter) const {
  Vector4 d = mode.x - filter.x;
  if (filter.oriented) d[3] = wrapAngle(d[3]);
  return y - H * d;
}

AxisMatrix Innovation::covarianceOf(const Matrix4& P) const { return H * P * H.transpose() + R; }

bool concerns(const MeasurementScan& scan, const Track& track, const FilterModel& model) {
  constexpr double kNeverOlder = 0.1;      // [s]
  constexpr double kMaxAcceleration = 10;  // [m/s^2] of what may happen meanwhile
  const double dt = scan.state.stamp - track.stamp;
  if (dt >= kNeverOlder - 1e-6) return true;
  for (ClassId j = 0; j < model.classes.size(); ++j) {
    if (!track.live(j)) continue;
    const ClassFilter& f = track.bank[static_cast<std::size_t>(j)];
    const bool speed_known = model.classes[j].motion == Motion::kWheeled && f.oriented;
    const double speed = speed_known ? std::abs(f.x[2]) : f.x.tail<2>().norm();
    const double sigma = std::sqrt(std::max(f.P(0, 0), f.P(1, 1)));
    const double reach = kCoarseGate * sigma + 0.5 * (f.extent.length + f.extent.width) +
                         kCoarseMargin + (speed + kMaxAcceleration * dt) * dt;
    if (scan.model->mayDetect(f.x.head<2>(), reach, scan.state)) return true;
    for (const auto& m : scan.measurements) {
      const double far = reach + kCoarseGate * m.position_sigma;
      if ((m.position - f.x.head<2>()).squaredNorm() <= far * far) return true;
    }
  }
  return false;
}

LikelihoodTable likelihoodTable(const std::vector<Track>& predicted,
                                const std::vector<char>& touched, const MeasurementScan& scan,
                                const FilterModel& model) {
  const Gates gates(model.params.gate_probability);
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
