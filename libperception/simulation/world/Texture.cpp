#include "libperception/simulation/world/Texture.h"

#include <cmath>

namespace perception {

double smoothValue(double x, double y, std::uint32_t salt) {
  const double fx = std::floor(x), fy = std::floor(y);
  const auto i = static_cast<std::int64_t>(fx), j = static_cast<std::int64_t>(fy);
  const auto ease = [](double s) { return s * s * (3 - 2 * s); };
  const double u = ease(x - fx), v = ease(y - fy);
  return (1 - v) * ((1 - u) * cellValue(i, j, salt) + u * cellValue(i + 1, j, salt)) +
         v * ((1 - u) * cellValue(i, j + 1, salt) + u * cellValue(i + 1, j + 1, salt));
}

std::uint32_t hashOf(const std::string& name) {
  std::uint32_t hash = 2166136261u;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 16777619u;
  return mixed(hash);
}

}  // namespace perception
