#pragma once
#include <vector>

#include "libperception/measurement/objects/ObjectClass.h"
#include "libperception/scene/Scene.h"

namespace perception {

/// The side of the road that traffic keeps to.
enum class TrafficSide { kRight, kLeft, kUnknown };

/// Turns standing vehicles and cyclists whose front nothing of their own surely tells the way that
/// others make likelier (method.md 5.11): the nearest one in their row whose front is known, else
/// the own vehicle, which faces as those on its side of the road do. Their p_front stays below
/// kSureFront.
void turnUntoldFronts(const EgoState& ego, TrafficSide traffic, const ClassTable& classes,
                      std::vector<SceneObject>& objects);

}  // namespace perception
