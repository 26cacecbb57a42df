#include "libperception/filter/likelihood/AssignmentPrior.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "libperception/core/math/Angle.h"
#include "libperception/core/math/LogMath.h"
#include "libperception/filter/state/ClassFilterMotion.h"

namespace perception {
namespace {

constexpr double kHighest = 4;  // [m] clutter has any height up to this (method.md 5.15)
constexpr double kHeightScatter =
    0.15;  // [m] standard deviation of a detection's height about the object's
constexpr double kBaseScatter = 0.15;  // [m] of its lowest point
constexpr double kGroundSigma = 0.5;   // [m] of the ground about the vehicle's own

double logNormal(double d, double variance) {
  return -0.5 * (d * d / variance + std::log(kTwoPi * variance));
}

/// One detection in a hundred is truncated or merged and has any height.
double logMostly(double d, double variance) {
  return std::log(0.99 * std::exp(logNormal(d, variance)) + 0.01 / kHighest);
}

}  // namespace

double logShape(const Track& track, const Measurement& m) {
  double sum = 0;
  if (m.height) {
    sum += logMostly(m.height->mean - track.height.mean,
                     m.height->variance + track.height.variance + kHeightScatter * kHeightScatter);
  }
  if (m.base_z) {
    sum += logMostly(m.base_z->mean - track.base_z.mean,
                     m.base_z->variance + track.base_z.variance + kBaseScatter * kBaseScatter);
  }
  return sum;
}

double logShape(const ObjectClass& c, const Measurement& m, const SensorState& sensor) {
  double sum = 0;
  if (m.height) {
    sum +=
        logMostly(m.height->mean - c.height, m.height->variance + c.height_sigma * c.height_sigma +
                                                 kHeightScatter * kHeightScatter);
  }
  if (m.base_z) {
    sum += logMostly(m.base_z->mean - sensor.ego.T_world_ego.translation().z(),
                     m.base_z->variance + kGroundSigma * kGroundSigma);
  }
  return sum;
}

void weighShape(const Measurement& m, const SensorState& sensor, const FilterModel& model,
                BirthLikelihood& births) {
  // The height enters the class probabilities of a newborn in the update, not here.
  std::vector<double> shape = births.log_class;
  for (ClassId j = 0; j < model.classes.size(); ++j)
    shape[static_cast<std::size_t>(j)] += logShape(model.classes[j], m, sensor);
  births.log_birth += logSumExp(shape);
  births.log_clutter -= std::log(kHighest) * ((m.height ? 1 : 0) + (m.base_z ? 1 : 0));
}

const RegionSeen* regionOf(const Track& track, const MeasurementScan& scan,
                           const FilterModel& model) {
  if (model.params.region_memory <= 0) return nullptr;
  const std::uint64_t sensor = sensorKey(scan.sensor);
  for (const auto& r : track.regions)
    if (r.sensor == sensor) return &r;
  return nullptr;
}

Innovation withRegion(Innovation innovation, const RegionSeen& region, const Measurement& m,
                      const MeasurementScan& scan, const FilterModel& model) {
  const double dt = scan.state.stamp - region.stamp;
  const double rho = model.params.region_memory * std::exp(-dt / model.params.region_time);
  const AxisMatrix before = innovation.R;
  std::array<double, kMaxAxes> carried{};  // by axis seen now: rho where it was seen then
  Eigen::Index now = 0, then = 0;
  for (std::size_t i = 0; i < scan.model->axes().size(); ++i) {
    const bool is = m.seen >> i & 1, was = region.seen >> i & 1;
    if (is && was) {
      innovation.y[now] -= rho * region.error[then];
      carried[static_cast<std::size_t>(now)] = rho;
    }
    now += is;
    then += was;
  }
  // D R D with D = sqrt(1 - rho^2): stays positive definite for any axes.
  const auto left = [&](Eigen::Index i) {
    const double c = carried[static_cast<std::size_t>(i)];
    return std::sqrt(1 - c * c);
  };
  for (Eigen::Index a = 0; a < now; ++a)
    for (Eigen::Index b = 0; b < now; ++b) innovation.R(a, b) *= left(a) * left(b);
  innovation.S += innovation.R - before;
  return innovation;
}

void rememberRegion(const Measurement& m, const MeasurementScan& scan, const FilterModel& model,
                    Track& track) {
  const ClassId best = track.likeliestClass();
  const ClassFilter& f = track.bank[track.filterOf(static_cast<std::size_t>(best))];
  const ClassId of = track.decided_class < 0 ? best : track.decided_class;
  // Models predict whole banks: put the filter at the index of its class.
  std::vector<Kinematics> kinematics(static_cast<std::size_t>(of) + 1,
                                     kinematicsOf(model.classes[of], f));
  const std::vector<Extent> extents(kinematics.size(), f.extent);
  std::vector<AxisPrediction> seen(kinematics.size());
  scan.model->predict(kinematics.data(), extents.data(), kinematics.size(), scan.state,
                      seen.data());
  if (!seen.back().defined) return;
  const RegionSeen region{sensorKey(scan.sensor), scan.state.stamp, m.seen,
                          residual(*scan.model, m, seen.back().h)};
  const auto known = std::find_if(track.regions.begin(), track.regions.end(),
                                  [&](const RegionSeen& r) { return r.sensor == region.sensor; });
  known == track.regions.end() ? track.regions.push_back(region) : void(*known = region);
}

}  // namespace perception
