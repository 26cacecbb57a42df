#pragma once
#include <cstddef>
#include <utility>
#include <vector>

#include "libperception/scene/files/TrackedRun.h"

namespace perception {

/// Scenes of two runs that are of the same instant: pairs nearest in time, in order of time, at
/// most `most` [s] apart.
std::vector<std::pair<std::size_t, std::size_t>> commonInstants(const TrackedRun& a,
                                                                const TrackedRun& b, double most);

/// [m] between the centers of two objects on the ground, where `b` is moved by its velocity to an
/// instant `later` [s].
double distanceOf(const SceneObject& a, const SceneObject& b, double later);

/// The object of `b` by object of `a`, or -1: one to one, at most `reach` [m] apart, with the least
/// sum of distances, where an object of `a` without one counts as `reach`. Of equally near objects
/// one with the same id is taken.
std::vector<int> matchObjects(const Scene& a, const Scene& b, double reach);

}  // namespace perception
