#pragma once
#include "libperception/core/math/Random.h"

namespace perception {

struct CameraView;

/// Drops of water on a lens or the window before it: disks that cover `share` [0, 1) of the image
/// on average and blur it, with soft edges (method.md 9.14).
void addLensDrops(double share, CameraView& view, Rng& rng);

}  // namespace perception
