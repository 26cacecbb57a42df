#pragma once
#include <array>
#include <cstddef>

namespace perception {

/// P(X <= x) for X chi-square with `degrees_of_freedom` >= 1; 0 for x <= 0.
double chi2Cdf(double x, int degrees_of_freedom);

/// The x with chi2Cdf(x, degrees_of_freedom) = probability, for probability in (0, 1); relative
/// error below 1e-10.
double chi2Quantile(double probability, int degrees_of_freedom);

/// The quantiles of one probability for 1 to `most` degrees of freedom.
template <int most>
class Chi2Quantiles {
 public:
  explicit Chi2Quantiles(double probability) {
    for (int n = 1; n <= most; ++n) of_[static_cast<std::size_t>(n)] = chi2Quantile(probability, n);
  }
  double of(std::ptrdiff_t degrees_of_freedom) const {
    return of_[static_cast<std::size_t>(degrees_of_freedom)];
  }

 private:
  std::array<double, most + 1> of_{};
};

}  // namespace perception
