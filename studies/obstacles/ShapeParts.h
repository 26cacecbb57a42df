#pragma once
#include <vector>

#include "studies/obstacles/ObstacleShapes.h"

/// What the shapes of the obstacles study are made of. Lengths in meters, as of ShapeBox.
namespace perception::shape_parts {

using Boxes = std::vector<ShapeBox>;

/// Factors on the reflectivity of a wall (.4), for the materials of LidarSurface.
inline constexpr double kRubber = 0.15, kDark = 0.3, kCloth = 0.9, kFur = 0.7, kWood = 1.0,
                        kSteel = 1.2, kWhite = 1.5, kLeaves = 0.9, kStone = 0.8;

inline Boxes together(const std::vector<Boxes>& parts) {
  Boxes all;
  for (const Boxes& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

inline Boxes person(double x = 0, double y = 0, double cloth = kCloth) {
  return {{x, y - 0.11, 0, 0.2, 0.15, 0.85, kDark},
          {x + 0.1, y + 0.11, 0, 0.2, 0.15, 0.85, kDark},
          {x, y, 0.85, 0.26, 0.46, 0.62, cloth},
          {x + 0.03, y, 1.5, 0.2, 0.18, 0.24, 1.2}};
}

inline Boxes child(double x = 0, double y = 0, double tall = 1.05) {
  return {{x, y, 0, 0.16, 0.22, 0.45 * tall, kDark},
          {x, y, 0.45 * tall, 0.18, 0.28, 0.35 * tall, kCloth},
          {x, y, 0.8 * tall, 0.17, 0.17, 0.2 * tall, 1.2}};
}

inline Boxes wheels(double x, double half_track, double base_length, double radius) {
  Boxes all;
  for (const double along : {x, x + base_length})
    for (const double across : {-half_track, half_track})
      all.push_back({along, across, 0, 2 * radius, 0.25, 2 * radius, kRubber});
  return all;
}

/// A trunk on four legs, seen from its side or its tail: `along` lies in the lane's direction.
inline Boxes animal(double length, double width, double legs, double body, bool along) {
  const double l = along ? length : width, w = along ? width : length;
  Boxes all = {{0, 0, legs, l, w, body, kFur}};
  for (const double dx : {0.0, l - 0.1})
    for (const double dy : {-0.5 * w + 0.05, 0.5 * w - 0.05})
      all.push_back({dx, dy, 0, 0.1, 0.1, legs, kFur});
  const double head = 0.25 * length;
  if (along)
    all.push_back({l, 0, legs + 0.5 * body, head, 0.7 * width, 0.6 * body, kFur});
  else
    all.push_back(
        {0.1 * l, 0.5 * w + 0.5 * head, legs + 0.5 * body, 0.7 * l, head, 0.6 * body, kFur});
  return all;
}

/// Bars of one size side by side.
inline Boxes fence(int bars, double spacing, double bar, double base, double height,
                   double factor) {
  Boxes all;
  for (int i = 0; i < bars; ++i)
    all.push_back({0, spacing * (i - 0.5 * (bars - 1)), base, bar, bar, height, factor});
  return all;
}

/// A beam that rises to the left, as stairs of short boxes.
inline Boxes risingArm(double base, double rise, int steps) {
  Boxes all;
  for (int i = 0; i < steps; ++i)
    all.push_back({0, -2.0 + 0.4 * i, base + rise * i, 0.08, 0.4, 0.12, kWhite});
  return all;
}

/// Twigs: small boxes scattered by a fixed rule.
inline Boxes twigs(double length, double width, double base, double height, int count) {
  Boxes all;
  for (int i = 0; i < count; ++i) {
    const double a = 0.618034 * i - static_cast<int>(0.618034 * i);
    const double b = 0.754878 * i - static_cast<int>(0.754878 * i);
    const double c = 0.569840 * i - static_cast<int>(0.569840 * i);
    all.push_back(
        {length * a, width * (b - 0.5), base + height * c, 0.12, 0.12, 0.06, kLeaves, 360 * a});
  }
  return all;
}

}  // namespace perception::shape_parts
