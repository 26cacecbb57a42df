#pragma once
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "libperception/simulation/world/EncounterScenes.h"

namespace perception::test {
namespace encounters {

constexpr double kStep = 0.1;  // [s]

/// A drive along one axis: v(t) integrated from the start.
template <class Speed>
std::vector<Vector2> drive(const Vector2& from, const Vector2& direction, double duration,
                           Speed speed) {
  std::vector<Vector2> path;
  double s = 0;
  for (int i = 0; i <= static_cast<int>(duration / kStep + 0.5); ++i) {
    s += std::max(0.0, speed(i * kStep)) * kStep;
    path.push_back(from + s * direction);
  }
  return path;
}

inline EncounterScene meeting(double separation, double pause, Rng& rng) {
  EncounterScene scene;
  const double speed = 1.3, meet = 4.6, duration = 14;  // [m/s], [s], [s]
  const bool turn_back = rng.uniform() < 0.5;
  for (const double side : {1.0, -1.0}) {
    EncounterScene::Object o;
    Vector2 wander = Vector2::Zero();
    for (int i = 0; i <= static_cast<int>(duration / kStep + 0.5); ++i) {
      const double t = i * kStep;
      double y = side * (6.2 - speed * std::min(t, meet));
      if (t >= meet + pause) y += (turn_back ? side : -side) * speed * (t - meet - pause);
      wander += 0.03 * std::sqrt(kStep) * Vector2(rng.normal(), rng.normal());
      o.path.push_back(Vector2(9 + side * separation / 2, y) + wander);
    }
    scene.objects.push_back(std::move(o));
  }
  return scene;
}

inline double numberAfter(const std::string& name, std::size_t from,
                          std::size_t count = std::string::npos) {
  try {
    return std::stod(name.substr(from, count));
  } catch (const std::exception&) {
    throw std::invalid_argument("encounter '" + name +
                                "': expected A, B, C<distance>, D or E<separation>_<pause>");
  }
}

}  // namespace encounters

/// By name: A (an oncoming car stops and passes), B (a crossing car), Cd (two pedestrians cross at
/// a distance of d meters), D (four pedestrians in a crowd, two parked cars), Es_p (two pedestrians
/// meet at a distance of s meters, pause p seconds, then pass or turn back).
inline EncounterScene encounterScene(const std::string& name, Rng& rng) {
  using namespace encounters;
  EncounterScene scene;
  const char kind = name.empty() ? ' ' : name[0];
  if (kind == 'A') {
    const auto speed = [](double t) {
      return t < 3 ? 6 - 2 * t : t < 6 ? 0 : std::min((t - 6) * 1.5, 8.0);
    };
    scene.objects.push_back({true, drive({19, 3.5}, {-1, 0}, 14, speed)});
    for (auto& p : scene.objects[0].path) p.x() = std::max(p.x(), -5.0);
  } else if (kind == 'B') {
    const auto speed = [](double t) {
      return t < 2.5 ? 5 - 2 * t : t < 4.5 ? 0 : std::min((t - 4.5) * 1.5, 8.0);
    };
    scene.objects.push_back({true, drive({12, -13}, {0, 1}, 12, speed)});
  } else if (kind == 'C') {
    const double d = name.size() > 1 ? numberAfter(name, 1) : 1.0;
    for (const double side : {1.0, -1.0}) {
      const double x = 9 + side * d / 2;
      scene.objects.push_back({false, encounterWalk({x, -8 * side}, {x, 8 * side},
                                                    1.35 + rng.normal(0, 0.1), 12, 0.03, rng)});
    }
  } else if (kind == 'D') {
    double side = 1;
    for (const double x : {8.0, 8.5, 9.0, 9.6}) {
      scene.objects.push_back({false, encounterWalk({x, -8 * side}, {x, 8 * side},
                                                    1.3 + rng.normal(0, 0.15), 12, 0.03, rng)});
      side = -side;
    }
    for (const double y : {3.0, -3.0})
      scene.objects.push_back({true, std::vector<Vector2>(121, Vector2(15, y))});
  } else if (kind == 'E') {
    const auto bar = name.find('_');
    const bool plain = name.size() == 1;
    if (!plain && bar == std::string::npos) numberAfter("", 0);
    scene = plain ? meeting(0.5, 1.5, rng)
                  : meeting(numberAfter(name, 1, bar - 1), numberAfter(name, bar + 1), rng);
  } else {
    throw std::invalid_argument("encounter '" + name +
                                "': expected A, B, C<distance>, D or E<separation>_<pause>");
  }
  return scene;
}

}  // namespace perception::test
