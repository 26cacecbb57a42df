#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace perception {

/// What a cluster of returns can be told to be by its shape alone. Classes of the configuration
/// name theirs ([class.NAME] shape).
enum class ClusterKind : std::uint8_t {
  kPedestrian,
  kCyclist,
  kVehicle,
  kThing,  ///< no road user: a wall, a pole, a bush
  kMixed,  ///< not one object: several grown together, or a fragment of one
};
inline constexpr std::size_t kClusterKinds = 5;
inline constexpr std::size_t kShapes = 4;  ///< kinds that a class can have (ObjectShape)

inline constexpr std::array<const char*, kClusterKinds> kClusterKindNames = {
    "pedestrian", "cyclist", "vehicle", "thing", "mixed"};

}  // namespace perception
