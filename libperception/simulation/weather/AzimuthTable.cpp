#include "libperception/simulation/weather/AzimuthTable.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Angle.h"

namespace perception {
namespace {

constexpr int kBins = 360;

std::size_t binOf(double azimuth) {
  const double turn = (azimuth + kPi) / kTwoPi;
  return static_cast<std::size_t>(turn * kBins) % kBins;
}

}  // namespace

AzimuthTable::AzimuthTable() : bins_(kBins) {}

void AzimuthTable::reset(const Vector2& eye) {
  eye_ = eye;
  for (auto& bin : bins_) bin.clear();
}

void AzimuthTable::add(const Vector2& place, double reach, std::uint32_t item) {
  const Vector2 arm = place - eye_;
  const double range = arm.norm(), half = range > reach ? std::asin(reach / range) : kPi;
  const double first = std::atan2(arm.y(), arm.x()) - half;
  // Whole bins: one more where the interval begins inside of one.
  const int bins = std::min(kBins, static_cast<int>(std::ceil(2 * half / kTwoPi * kBins)) + 1);
  const std::size_t start = binOf(wrapAngle(first));
  for (int k = 0; k < bins; ++k)
    bins_[(start + static_cast<std::size_t>(k)) % kBins].push_back(item);
}

const std::vector<std::uint32_t>& AzimuthTable::along(const Vector3& direction) const {
  return bins_[binOf(std::atan2(direction.y(), direction.x()))];
}

}  // namespace perception
