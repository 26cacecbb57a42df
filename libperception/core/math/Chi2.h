#pragma once

namespace perception {

/// P(X <= x) for X chi-square with `degrees_of_freedom` >= 1; 0 for x <= 0.
double chi2Cdf(double x, int degrees_of_freedom);

/// The x with chi2Cdf(x, degrees_of_freedom) = probability, for probability in (0, 1); relative
/// error below 1e-10.
double chi2Quantile(double probability, int degrees_of_freedom);

}  // namespace perception
