#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace perception {

/// A piecewise linear curve through knots, tabulated: a multiplication and a look-up per return.
class TrustCurve {
 public:
  TrustCurve() = default;
  TrustCurve(const std::vector<double>& knots, const std::vector<double>& values);
  float at(float v) const {
    const float place = (v - low_) * per_unit_ + 0.5F;
    const float low = place > 0 ? place : 0;
    return table_[static_cast<std::size_t>(static_cast<int>(low < kLast ? low : kLast))];
  }
  /// Indices into table() that at() would use, for `count` values.
  void findPlaces(const float* values, std::size_t count, std::int32_t* places) const;
  const float* table() const { return table_.data(); }

 private:
  static constexpr int kLast = 511;
  float low_ = 0, per_unit_ = 1;
  std::array<float, kLast + 1> table_{};
};

}  // namespace perception
