#include "libperception/filter/likelihood/Gating.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libperception/core/math/Angle.h"
#include "libperception/core/math/Chi2.h"
#include "libperception/filter/predict/Prediction.h"
#include "libperception/measurement/models/PositionOnlyModel.h"

namespace perception {
namespace {

/// Coarse gate [standard deviations], plus 2 m for the size.
constexpr double kCoarseGate = 6;
constexpr double kCoarseMargin = 2;        // [m]
constexpr double kSlack = 1e-6;            // [m] rounding tolerance of distances
constexpr double kNisRounding = 1 + 1e-6;  // rounding tolerance of a NIS, relative

/// Reach of one class filter [m], the measurement's own deviation left out.
double coarseReach(const ClassFilter& f) {
  return kCoarseGate * std::sqrt(std::max(f.P(0, 0), f.P(1, 1))) +
         0.5 * std::max(f.extent.length, f.extent.width) + kCoarseMargin;
}

}  // namespace

Gates::Gates(double probability) {
  for (int n = 1; n <= kMaxAxes; ++n)
    quantile[static_cast<std::size_t>(n)] = chi2Quantile(probability, n);
}

const Gates& Gates::of(double probability) {
  thread_local double last = -1;
  thread_local Gates gates(0.5);
  if (probability != last) {
    gates = Gates(probability);
    last = probability;
  }
  return gates;
}

BoundingDisc::BoundingDisc(const Track& track) {
  bool first = true;
  for (std::size_t j = 0; j < track.bank.size(); ++j) {
    if (!track.live(static_cast<ClassId>(j))) continue;
    const ClassFilter& f = track.bank[j];
    if (first) center = f.x.head<2>();
    first = false;
    spread = std::max(spread, (f.x.head<2>() - center).squaredNorm());
    size = std::max(size, 0.5 * std::max(f.extent.length, f.extent.width));
    reach = std::max(reach, coarseReach(f));
  }
  spread = std::sqrt(spread);
}

bool BoundingDisc::mayBeNear(const Measurement& m) const {
  const double far = reach + kCoarseGate * m.position_sigma + spread + kSlack;
  return !((m.position - center).squaredNorm() > far * far);
}

bool coarseGate(const Track& track, const Measurement& m) {
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

AxisBounds::AxisBounds(const ClassFilter& filter, const Kinematics& k,
                       const AxisPrediction& prediction)
    : prediction_(prediction), applies_(filter.modes.empty()) {
  if (!prediction.defined || !applies_) return;
  for (Eigen::Index a = 0; a < prediction.h.size(); ++a) {
    const auto& H = prediction.H_q;
    double variance = 0;
    if (H(a, 2) == 0 && H(a, 3) == 0 && H(a, 4) == 0) {  // position only
      const double x = H(a, 0), y = H(a, 1);
      variance = x * x * filter.P(0, 0) + 2 * x * y * filter.P(0, 1) + y * y * filter.P(1, 1);
    } else {
      const Eigen::RowVector4d row = H.row(a) * k.J;
      variance = row * filter.P * row.transpose();
    }
    const double l = prediction.H_extent(a, 0), w = prediction.H_extent(a, 1);
    variance += l * l * filter.extent.var_length + w * w * filter.extent.var_width;
    if (prediction.R_model.size() > 0) variance += prediction.R_model(a, a);
    variance_[static_cast<std::size_t>(a)] = variance + 2e-9;
  }
}

bool AxisBounds::exclude(const Measurement& m, const std::vector<AxisKind>& kinds,
                         double gate) const {
  if (!prediction_.defined) return true;
  if (!applies_) return false;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    if (!(m.seen >> i & 1)) continue;
    const auto a = static_cast<Eigen::Index>(i);
    double y = m.z[a] - prediction_.h[a];
    if (kinds[i] == AxisKind::kAngle && std::abs(y) > kPi) y = wrapAngle(y);
    if (y * y > gate * kNisRounding * (variance_[i] + m.R(a, a))) return true;
  }
  return false;
}

ReachableDisc reachableDiscOf(const Track& track, const FilterModel& model) {
  const BoundingDisc around(track);
  ReachableDisc w;
  w.center = around.center;
  w.reach = around.spread + kSlack;
  w.longest_deferral = kLongestDeferral;
  w.expires = track.stamp + std::min(timeToLive(track, model), kLongestDeferral);
  double speed2 = 0;
  for (ClassId j = 0; j < model.classes.size(); ++j) {
    const ClassFilter& f = track.bank[static_cast<std::size_t>(j)];
    const MotionModel& motion = *model.classes[j].motion;
    if (!track.live(j) || !motion.moves) continue;
    const auto move = [&](const Vector4& x, const Matrix4& P) {
      // The mean of v e^(i theta) grows by the covariance of both, at most var v / e (MotionModel).
      const double own = f.oriented ? x[2] * x[2] + P(2, 2) / std::exp(1.0)
                                    : motion.kinematics(x, false).q.segment<2>(2).squaredNorm();
      speed2 = std::max(speed2, own);
    };
    if (!f.modes.empty()) w.longest_deferral = kLongestDeferralOfModes;
    move(f.x, f.P);
    for (const ModeFilter& mode : f.modes) move(mode.x, mode.P);
  }
  w.speed = std::sqrt(speed2);
  return w;
}

bool isPositionOnly(const MeasurementScan& scan) { return scan.model->positionOnly() != nullptr; }

bool mayBeInView(const MeasurementScan& scan, const Track& track, bool position_only) {
  constexpr double kMargin = 1;  // [m] beyond the objects' own size
  const ReachableDisc& w = track.reachable;
  const double body = position_only ? 0 : 2 * BoundingDisc(track).size + kMargin;
  const double dt = scan.state.stamp - track.stamp;
  return dt >= w.longest_deferral - 1e-6 || w.reach == std::numeric_limits<double>::infinity() ||
         scan.model->mayDetect(w.center, w.reach + body + w.speed * dt, scan.state);
}

}  // namespace perception
