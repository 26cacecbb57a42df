#include "libperception/core/math/Chi2.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <unsupported/Eigen/SpecialFunctions>

#include "libperception/core/math/LogMath.h"

namespace perception {

double chi2Cdf(double x, int degrees_of_freedom) {
  assert(degrees_of_freedom >= 1);
  return x <= 0 ? 0 : Eigen::numext::igamma(0.5 * degrees_of_freedom, 0.5 * x);
}

double chi2Quantile(double probability, int degrees_of_freedom) {
  assert(probability > 0 && probability < 1);
  double low = 0;
  double high = std::max(1.0, 2.0 * degrees_of_freedom);
  while (chi2Cdf(high, degrees_of_freedom) < probability) high *= 2;
  while (high - low >
         1e-12 * high) {  // bisection: the cdf is monotone, and this is not time-critical
    const double middle = 0.5 * (low + high);
    if (middle == low || middle == high) break;
    (chi2Cdf(middle, degrees_of_freedom) < probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace perception
