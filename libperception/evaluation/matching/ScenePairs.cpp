#include "libperception/evaluation/matching/ScenePairs.h"

#include <cmath>

#include "libperception/core/math/Assignment.h"

namespace perception {
namespace {

constexpr double kSameId = 1e-6;  // [m] by which objects of the same id are nearer: equal places

}  // namespace

std::vector<std::pair<std::size_t, std::size_t>> commonInstants(const TrackedRun& a,
                                                                const TrackedRun& b, double most) {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  const auto apart = [&](std::size_t i, std::size_t j) {
    return std::abs(a.scenes[i].stamp - b.scenes[j].stamp);
  };
  std::size_t i = 0, j = 0;
  while (i < a.scenes.size() && j < b.scenes.size()) {
    const double now = apart(i, j);
    if (i + 1 < a.scenes.size() && apart(i + 1, j) < now) {
      ++i;
    } else if (j + 1 < b.scenes.size() && apart(i, j + 1) < now) {
      ++j;
    } else {
      if (now <= most) pairs.emplace_back(i, j);
      ++i, ++j;
    }
  }
  return pairs;
}

double distanceOf(const SceneObject& a, const SceneObject& b, double later) {
  return (a.position.head<2>() - b.position.head<2>() - later * b.velocity).norm();
}

std::vector<int> matchObjects(const Scene& a, const Scene& b, double reach) {
  const double later = a.stamp - b.stamp;
  const auto columns = static_cast<int>(b.objects.size());
  AssignmentSolver solver;
  solver.begin(columns + static_cast<int>(a.objects.size()));
  for (std::size_t r = 0; r < a.objects.size(); ++r) {
    for (std::size_t c = 0; c < b.objects.size(); ++c) {
      const SceneObject &x = a.objects[r], &y = b.objects[c];
      const double distance = distanceOf(x, y, later);
      if (!(distance <= reach)) continue;
      solver.addOption(static_cast<int>(c), distance - (x.id == y.id ? kSameId : 0));
    }
    solver.addOption(columns + static_cast<int>(r), reach);
    solver.endRow();
  }
  std::vector<int> column = solver.solve().column;
  for (int& c : column)
    if (c >= columns) c = -1;
  return column;
}

}  // namespace perception
