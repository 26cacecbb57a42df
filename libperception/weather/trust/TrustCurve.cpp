#include "libperception/weather/trust/TrustCurve.h"

#include <algorithm>

#include "libperception/simd/Dispatch.h"

namespace perception {
namespace {

PERCEPTION_WIDEST void findAll(const float* __restrict values, std::size_t count, float first,
                               float per_unit, float last, std::int32_t* __restrict places) {
  for (std::size_t i = 0; i < count; ++i) {
    const float place = (values[i] - first) * per_unit + 0.5F;
    const float low = place > 0 ? place : 0;
    places[i] = static_cast<std::int32_t>(low < last ? low : last);
  }
}

}  // namespace

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

void TrustCurve::findPlaces(const float* values, std::size_t count, std::int32_t* places) const {
  findAll(values, count, low_, per_unit_, kLast, places);
}

}  // namespace perception
