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
  kThing,    ///< no road user: a wall, a pole, a bush
  kPhantom,  ///< no surface: spray, snow, rain, exhaust, a mirror image in a wet road
  kMixed,    ///< not one object: several grown together, or a fragment of one
};
inline constexpr std::size_t kClusterKinds = 6;
inline constexpr std::size_t kRoadUsers = 3;  ///< the first kinds
inline constexpr std::size_t kShapes = 5;     ///< kinds that a class can have (ObjectShape)

inline constexpr std::array<const char*, kClusterKinds> kClusterKindNames = {
    "pedestrian", "cyclist", "vehicle", "thing", "phantom", "mixed"};

}  // namespace perception
