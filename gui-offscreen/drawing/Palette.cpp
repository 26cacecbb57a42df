#include "gui-offscreen/drawing/Palette.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace perception {
namespace {

// Five colors of matplotlib's viridis without the yellow end, which has no contrast on white.
constexpr std::array<Color, 5> kRamp = {
    {{68, 1, 84}, {65, 68, 135}, {42, 120, 142}, {34, 168, 132}, {122, 209, 81}}};

std::uint8_t between(std::uint8_t a, std::uint8_t b, double share) {
  return static_cast<std::uint8_t>(std::lround(a + share * (b - a)));
}

}  // namespace

Color colorOfHeight(double height) {
  const double share = std::clamp((height - kHeightLow) / (kHeightHigh - kHeightLow), 0.0, 1.0);
  const double place = share * static_cast<double>(kRamp.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(place), kRamp.size() - 2);
  const double f = place - static_cast<double>(i);
  return {between(kRamp[i].r, kRamp[i + 1].r, f), between(kRamp[i].g, kRamp[i + 1].g, f),
          between(kRamp[i].b, kRamp[i + 1].b, f)};
}

}  // namespace perception
