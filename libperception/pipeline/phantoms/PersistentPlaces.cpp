#include "libperception/pipeline/phantoms/PersistentPlaces.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace perception {
namespace {

constexpr double kCube = 0.4;           // [m] two cells (assumed)
constexpr std::ptrdiff_t kSeveral = 2;  // returns in a cube (assumed)

struct CubePlace {
  std::int64_t x, y, z;
  /// That of a key; places repeat after 2^21 cubes.
  static CubePlace of(std::uint64_t key) {
    const auto part = [](std::uint64_t v) { return static_cast<std::int64_t>(v & 0x1FFFFFU); };
    return {part(key >> 42), part(key >> 21), part(key)};
  }
  std::uint64_t key() const {
    const auto part = [](std::int64_t v) { return static_cast<std::uint64_t>(v) & 0x1FFFFFU; };
    return part(x) << 42 | part(y) << 21 | part(z);
  }
};

CubePlace cubeOf(const Vector3& p) {
  const auto at = [](double v) { return static_cast<std::int64_t>(std::floor(v / kCube)); };
  return {at(p.x()), at(p.y()), at(p.z())};
}

/// Whether it or one beside it holds some: a surface may lie at the border of two.
bool isAbout(const std::vector<std::uint64_t>& cubes, const CubePlace& cube) {
  for (std::int64_t y = -1; y <= 1; ++y)
    for (std::int64_t x = -1; x <= 1; ++x)
      if (std::binary_search(cubes.begin(), cubes.end(),
                             CubePlace{cube.x + x, cube.y + y, cube.z}.key()))
        return true;
  return false;
}

}  // namespace

std::vector<char> PersistentPlaces::add(const std::vector<Vector3>& surfaces) {
  std::vector<std::uint64_t> all, now;
  all.reserve(surfaces.size());
  for (const Vector3& p : surfaces) all.push_back(cubeOf(p).key());
  std::sort(all.begin(), all.end());
  for (auto first = all.begin(); first != all.end();) {
    const auto next = std::upper_bound(first, all.end(), *first);
    if (next - first >= kSeveral) now.push_back(*first);
    first = next;
  }
  std::vector<char> again(surfaces.size(), 0);
  if (!before_.empty()) {
    std::vector<char> seen;  // of each cube, whether it was about one of the scan before
    seen.reserve(now.size());
    for (const std::uint64_t key : now) seen.push_back(isAbout(before_, CubePlace::of(key)));
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
      const std::uint64_t key = cubeOf(surfaces[i]).key();
      const auto at = std::lower_bound(now.begin(), now.end(), key);
      again[i] = at != now.end() && *at == key && seen[static_cast<std::size_t>(at - now.begin())];
    }
  }
  before_ = std::move(now);
  return again;
}

}  // namespace perception
