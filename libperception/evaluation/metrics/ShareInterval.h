#pragma once
#include <algorithm>
#include <cmath>

namespace perception {

/// 95 % limits of a share.
struct ShareInterval {
  double low = 0, high = 1;
};

/// Two-sided 95 % interval of Wilson [brown2001] for an observed share `p` of `n` independent
/// trials; n > 0 and not necessarily whole (an effective number).
inline ShareInterval wilsonInterval(double p, double n) {
  constexpr double z = 1.959963984540054, z2 = z * z;  // normal quantile of 97.5 %
  const double middle = (p + z2 / (2 * n)) / (1 + z2 / n);
  const double half = z / (1 + z2 / n) * std::sqrt(p * (1 - p) / n + z2 / (4 * n * n));
  return {std::max(0.0, middle - half), std::min(1.0, middle + half)};
}

}  // namespace perception
