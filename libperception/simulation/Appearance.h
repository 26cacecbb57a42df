#pragma once
#include "libperception/simulation/Lighting.h"
#include "libperception/simulation/Mesh.h"

namespace perception {

struct ObjectParams;

/// How a surface returns light to a camera.
struct Finish {
  Rgb reflectance = Rgb::Zero();  ///< Lambert
  double mirror = 0;  ///< share of light that is mirrored at normal incidence; 0: a dull surface
};

/// Color of the coachwork, clothes or plaster of an object: stable for its name, common colors of
/// its kind (assumed). Cars of a reflectivity below 1 are darker.
Rgb bodyColor(const ObjectParams& object);

/// What a place of an object looks like: material, and for plain bodies the details that a camera
/// would show (lamps, rims, windows of houses, trousers and hair). `place` [m] and `normal` in the
/// object's frame; detail finer than `pixel` [m] is left out.
Finish finishOf(const ObjectParams& object, Material material, const Vector3& place,
                const Vector3& normal, double pixel);

}  // namespace perception
