#pragma once
#include <cstdint>
#include <string>

namespace perception {

/// Mixes the bits (finalizer of MurmurHash3): patterns of rendered surfaces are functions of place
/// and name alone, no random numbers.
constexpr std::uint32_t mixed(std::uint32_t h) {
  h ^= h >> 16, h *= 0x85ebca6bu, h ^= h >> 13, h *= 0xc2b2ae35u;
  return h ^ h >> 16;
}

/// In [0, 1), stable for a cell of a grid.
inline double cellValue(std::int64_t i, std::int64_t j, std::uint32_t salt) {
  return mixed(mixed(mixed(salt) ^ static_cast<std::uint32_t>(i)) ^ static_cast<std::uint32_t>(j)) *
         0x1p-32;
}

/// Between the values of the four cells around, smooth; x, y in cells.
double smoothValue(double x, double y, std::uint32_t salt);

/// FNV-1a of a name: an object looks the same in every run, whatever stands beside it.
std::uint32_t hashOf(const std::string& name);

}  // namespace perception
