#pragma once
#include "libperception/simulation/world/Lighting.h"
#include "libperception/simulation/world/Mesh.h"

namespace perception {

struct ObjectParams;

/// How a surface returns light to a camera.
struct Finish {
  Rgb reflectance = Rgb::Zero();  ///< Lambert
  double mirror = 0;              ///< specular reflectance at normal incidence; 0: diffuse
};

/// Color of the body paint, clothes or plaster of an object: a function of its name, from common
/// colors of its kind (assumed). Cars of a reflectivity below 1 are darker.
Rgb bodyColor(const ObjectParams& object);

/// A box of 4 m or more: it has windows, a lower one is a wall of blocks (assumed).
bool isHouse(const ObjectParams& object);

/// Appearance of a point of an object: material, and details that the geometry lacks (lamps, rims,
/// windows of houses, trousers and hair). `place` [m] and `normal` in the object's frame; detail
/// finer than `pixel` [m] is omitted.
Finish finishOf(const ObjectParams& object, Material material, const Vector3& place,
                const Vector3& normal, double pixel);

}  // namespace perception
