#include "studies/gps/GpsNoise.h"

#include <nlopt.h>

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Angle.h"

namespace perception {
namespace {

constexpr double kLeastDensity =
    -15;                           // lower bound of the log density: excludes jumps of the receiver
constexpr int kEvaluations = 150;  // of the optimizer

/// Data of the optimizer: sections of one class, covariance of the receiver.
struct NoiseProblem {
  const std::vector<std::vector<Vector2>>* sections;
  Matrix2 R;  // [m^2]
  PaperClass object_class;
};

void setNoise(const double* log_sigma, PaperClass& c) {
  c.accel_sigma = std::exp(log_sigma[0]);
  if (c.wheeled) c.rotation_sigma = std::exp(log_sigma[1]);
}

double logLikelihood(unsigned, const double* log_sigma, double*, void* data) {
  auto& problem = *static_cast<NoiseProblem*>(data);
  setNoise(log_sigma, problem.object_class);
  double sum = 0;
  for (const auto& section : *problem.sections) {
    const auto trace = runPaperFilter(problem.object_class, section, 1.0, problem.R);
    for (std::size_t k = 2; k < trace.log_density.size(); ++k)
      sum += std::max(trace.log_density[k],
                      kLeastDensity);  // excludes jumps of the receiver
  }
  return sum;
}

}  // namespace

PaperClass fitNoise(bool wheeled, const std::vector<std::vector<Vector2>>& sections,
                    const Matrix2& R) {
  NoiseProblem problem{&sections, R, {}};
  problem.object_class.wheeled = wheeled;
  if (sections.empty()) return problem.object_class;
  const unsigned n = wheeled ? 2 : 1;
  nlopt_opt optimizer = nlopt_create(NLOPT_LN_NELDERMEAD, n);
  const double low[2] = {std::log(1e-3), std::log(radians(0.1))};
  const double high[2] = {std::log(10.0), std::log(radians(180))};
  double x[2] = {std::log(0.5), std::log(radians(15))}, best = 0;
  nlopt_set_lower_bounds(optimizer, low);
  nlopt_set_upper_bounds(optimizer, high);
  nlopt_set_max_objective(optimizer, logLikelihood, &problem);
  nlopt_set_maxeval(optimizer, kEvaluations);
  nlopt_set_xtol_rel(optimizer, 1e-4);
  nlopt_optimize(optimizer, x, &best);
  nlopt_destroy(optimizer);
  setNoise(x, problem.object_class);
  return problem.object_class;
}

}  // namespace perception
