#include "gui-offscreen/Palette.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace perception {
namespace {

struct ClassColor {
  const char* name;
  Color color;
};

constexpr ClassColor kByName[] = {{"pedestrian", {213, 94, 0}},
                                  {"cyclist", {0, 158, 115}},
                                  {"car", {0, 114, 178}},
                                  {"bus", {204, 121, 167}},
                                  {"static-other", {115, 115, 115}}};
constexpr std::array<Color, 3> kOthers = {{{230, 159, 0}, {86, 180, 233}, {0, 0, 0}}};

// Five places of matplotlib's viridis, without its yellow end, which vanishes on white.
constexpr std::array<Color, 5> kRamp = {
    {{68, 1, 84}, {65, 68, 135}, {42, 120, 142}, {34, 168, 132}, {122, 209, 81}}};

std::uint8_t between(std::uint8_t a, std::uint8_t b, double share) {
  return static_cast<std::uint8_t>(std::lround(a + share * (b - a)));
}

}  // namespace

Color colorOfClass(const std::string& name, int place) {
  for (const ClassColor& row : kByName) {
    if (name == row.name) return row.color;
  }
  return kOthers[static_cast<std::size_t>(std::max(0, place)) % kOthers.size()];
}

bool isMuted(const std::string& class_name) { return class_name == "static-other"; }

Color colorOfHeight(double height) {
  const double share = std::clamp((height - kHeightLow) / (kHeightHigh - kHeightLow), 0.0, 1.0);
  const double place = share * static_cast<double>(kRamp.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(place), kRamp.size() - 2);
  const double f = place - static_cast<double>(i);
  return {between(kRamp[i].r, kRamp[i + 1].r, f), between(kRamp[i].g, kRamp[i + 1].g, f),
          between(kRamp[i].b, kRamp[i + 1].b, f)};
}

}  // namespace perception
