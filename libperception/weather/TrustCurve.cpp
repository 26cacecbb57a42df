#include "libperception/weather/TrustCurve.h"

#include <algorithm>

namespace perception {

TrustCurve::TrustCurve(const std::vector<double>& knots, const std::vector<double>& values) {
  low_ = static_cast<float>(knots.front());
  per_unit_ = static_cast<float>(kLast / (knots.back() - knots.front()));
  std::size_t k = 0;
  for (std::size_t i = 0; i < table_.size(); ++i) {
    const double v =
        knots.front() + static_cast<double>(i) * (knots.back() - knots.front()) / kLast;
    while (k + 2 < knots.size() && v > knots[k + 1]) ++k;
    const double share = std::clamp((v - knots[k]) / (knots[k + 1] - knots[k]), 0.0, 1.0);
    table_[i] = static_cast<float>(values[k] + share * (values[k + 1] - values[k]));
  }
}

}  // namespace perception
