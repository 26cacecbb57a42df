#include "libperception/pipeline/health/WindowDirt.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Angle.h"

namespace perception {
namespace {

// All assumed.
constexpr double kDirtWindow = 1;           // [s] in which a direction with dirt returns nothing
constexpr std::size_t kLeastDirtScans = 5;  // in it
constexpr std::size_t kStep = 7;            // of the returns every seventh is looked at
constexpr std::size_t kReach = 4;           // [deg] to the neighbors that return
constexpr double kLowest = -20;             // [deg] elevation of the lowest row
constexpr double kLeastRow = 0.1;           // share of a row's directions that return: it has beams

}  // namespace

void WindowDirt::add(const LidarCloud& cloud, Stamp stamp) {
  if (!first_) first_ = stamp;
  last_ = stamp;
  ++scans_, returns_ = 0;
  const float low = std::sin(static_cast<float>(radians(kLowest))),
              high = std::sin(static_cast<float>(radians(kLowest + static_cast<double>(kRows))));
  // Other ones in every scan, so that all directions are looked at.
  for (std::size_t i = scans_ % kStep; i < cloud.size(); i += kStep) {
    const float x = cloud.x[i], y = cloud.y[i], z = cloud.z[i];
    const float up = z / std::sqrt(x * x + y * y + z * z);
    if (!(up > low && up < high)) continue;
    ++returns_;
    const double row = degrees(std::asin(static_cast<double>(up))) - kLowest;
    const double column = degrees(std::atan2(static_cast<double>(y), static_cast<double>(x))) + 180;
    const auto r = std::min(static_cast<std::size_t>(row), kRows - 1);
    const auto c = static_cast<std::size_t>(column) % kColumns;
    seen_[r * kColumns + c] = stamp.ns;
  }
}

std::optional<double> WindowDirt::share() const {
  if (!first_ || last_ - *first_ < kDirtWindow || scans_ < kLeastDirtScans) return std::nullopt;
  const std::int64_t since = last_.ns - static_cast<std::int64_t>(1e9 * kDirtWindow);
  std::size_t holes = 0, open = 0;
  for (std::size_t r = 0; r < kRows; ++r) {
    const auto sees = [&](std::size_t c) {
      return seen_[r * kColumns + c % kColumns] >= since && seen_[r * kColumns + c % kColumns] > 0;
    };
    std::size_t in_row = 0, holes_in_row = 0;
    for (std::size_t c = 0; c < kColumns; ++c) {
      in_row += sees(c);
      if (sees(c)) continue;
      bool left = false, right = false;
      for (std::size_t k = 1; k <= kReach; ++k)
        left = left || sees(c + k), right = right || sees(c + kColumns - k);
      holes_in_row += left && right;
    }
    if (static_cast<double>(in_row) < kLeastRow * kColumns) continue;
    open += in_row, holes += holes_in_row;
  }
  if (open == 0) return std::nullopt;
  return static_cast<double>(holes) / static_cast<double>(open + holes);
}

}  // namespace perception
