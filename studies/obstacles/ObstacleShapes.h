#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace perception {

/// A box of a shape: x away from the vehicle, y to its left, both from where the shape stands.
struct ShapeBox {
  double x = 0, y = 0, base = 0;             ///< [m] near side, middle, bottom above the road
  double length = 0, width = 0, height = 0;  ///< [m] along x, along y, upward
  double reflectivity = 1;                   ///< factor on that of a wall, .4 at 905 nm
  double yaw_deg = 0;                        ///< [deg] about its middle
};

/// What a vehicle has to do about a shape.
enum class ShapeDemand {
  kStop,  ///< it stands or hangs in the way
  kLow,   ///< in the way, but lower than height_min: may be called for
  kPass   ///< beside the way or above it
};

/// A thing that no detector was taught.
struct ObstacleShape {
  std::string name, kind;
  ShapeDemand demand = ShapeDemand::kStop;
  std::vector<ShapeBox> boxes;
};

/// People, animals, goods, plants, vehicles, barriers, what hangs, what is low, and what is not in
/// the way at all. Sizes are usual ones (assumed); none is of a recorded or simulated training
/// scene.
const std::vector<ObstacleShape>& obstacleShapes();

/// People and animals among them.
std::vector<ObstacleShape> livingShapes();

/// [m] of the highest point.
double topOf(const ObstacleShape& shape);

}  // namespace perception
