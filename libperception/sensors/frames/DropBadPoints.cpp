// Points that no sensor measured.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "libperception/sensors/frames/FromObservation.h"

namespace perception {
namespace {

/// Removes the elements of an array at the indices `bad`, which are ascending; keeps the order.
template <class Number>
void filterArray(std::vector<Number>& values, const std::vector<std::size_t>& bad) {
  if (values.empty()) return;
  const auto begin = values.begin();
  auto to = begin + static_cast<std::ptrdiff_t>(bad.front());
  for (std::size_t k = 0; k < bad.size(); ++k) {
    const std::size_t end = k + 1 < bad.size() ? bad[k + 1] : values.size();
    to = std::move(begin + static_cast<std::ptrdiff_t>(bad[k] + 1),
                   begin + static_cast<std::ptrdiff_t>(end), to);
  }
  values.erase(to, values.end());
}

constexpr std::size_t kPiece = 32;  // points, so that the compiler vectorizes a loop over them

/// Whether all points of a piece have squared ranges [m^2] in these bounds.
bool areWithin(const float* x, const float* y, const float* z, float least, float most) {
  std::int32_t outside = 0;
  for (std::size_t i = 0; i < kPiece; ++i) {
    const float range2 = x[i] * x[i] + y[i] * y[i] + z[i] * z[i];
    outside |= ((range2 > least) & (range2 < most)) ^ 1;
  }
  return outside == 0;
}

}  // namespace

void dropBadPoints(LidarCloud& cloud, DecodeCounts& counts) {
  std::vector<std::size_t> bad;
  counts.points += cloud.size();
  // A return at the largest range may be rounded beyond it, as its coordinates are floats.
  const double limit = static_cast<double>(cloud.max_range) * (1 + 1e-6);
  const double most = cloud.max_range > 0 ? limit * limit : std::numeric_limits<double>::max();
  // By floats, with more room than these round, nearly all points are surely in range.
  const auto surely = static_cast<float>(std::min(most, 1e30) * (1 - 1e-5));
  const float *px = cloud.x.data(), *py = cloud.y.data(), *pz = cloud.z.data();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (i % kPiece == 0)
      while (i + kPiece <= cloud.size() && areWithin(px + i, py + i, pz + i, 1e-6F, surely))
        i += kPiece;
    if (i == cloud.size()) break;
    const double x = px[i], y = py[i], z = pz[i];
    const double range2 = x * x + y * y + z * z;
    if (range2 > 0 && range2 <= most) continue;
    bad.push_back(i);
    ++(!std::isfinite(range2) ? counts.not_finite
       : range2 > 0           ? counts.beyond_range
                              : counts.no_range);
  }
  if (bad.empty()) return;
  const auto filter = [&bad](auto&... arrays) { (filterArray(arrays, bad), ...); };
  filter(cloud.x, cloud.y, cloud.z, cloud.intensity, cloud.ring, cloud.time_offset, cloud.echo,
         cloud.pulse_width, cloud.label);
}

}  // namespace perception
