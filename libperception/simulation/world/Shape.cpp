#include "libperception/simulation/world/Shape.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libperception/core/math/Random.h"
#include "libperception/simulation/world/Scenario.h"

namespace perception {
namespace {

constexpr std::uint32_t kLeafStream = 0x51A01, kRoadStream = 0x51A02;  // purposes of random numbers

void addWheels(Mesh& mesh, const Wheels& wheels, double half_width) {
  constexpr double kTireWidth = 0.22;  // [m]
  const double radius = wheels.radius;
  for (const double x : {wheels.front, wheels.rear}) {
    for (const double side : {-1.0, 1.0}) {
      addCylinder(mesh, {x, side * half_width, radius},
                  {x, side * (half_width - kTireWidth), radius}, radius, Material::kTire, 1, 14);
    }
  }
}

// A sedan: body with hood and trunk, glass all around the cabin.
Mesh carMesh(double l, double w, double h, const Wheels& wheels) {
  Mesh mesh;
  const double belt = 0.60 * h;
  addExtruded(mesh,
              {{-.5 * l, .15 * h},
               {.5 * l, .15 * h},
               {.5 * l, .40 * h},
               {.47 * l, .48 * h},
               {.20 * l, belt},
               {-.40 * l, belt},
               {-.5 * l, .55 * h}},
              .5 * w, Material::kPaint);
  addFrustum(mesh, {belt, -.42 * l, .20 * l, .48 * w}, {h, -.28 * l, .06 * l, .38 * w},
             Material::kGlass, Material::kPaint);
  addWheels(mesh, wheels, .5 * w);
  return mesh;
}

// A panel van: glass in the front third only.
Mesh vanMesh(double l, double w, double h, const Wheels& wheels) {
  Mesh mesh;
  const double belt = 0.50 * h;
  addExtruded(
      mesh,
      {{-.5 * l, .12 * h}, {.5 * l, .12 * h}, {.5 * l, .36 * h}, {.40 * l, belt}, {-.5 * l, belt}},
      .5 * w, Material::kPaint);
  addFrustum(mesh, {belt, .10 * l, .40 * l, .5 * w}, {h, .10 * l, .26 * l, .44 * w},
             Material::kGlass, Material::kPaint);
  addFrustum(mesh, {belt, -.5 * l, .10 * l, .5 * w}, {h, -.49 * l, .10 * l, .46 * w},
             Material::kPaint, Material::kPaint);
  addWheels(mesh, wheels, .5 * w);
  return mesh;
}

Mesh busMesh(double l, double w, double h, const Wheels& wheels) {
  Mesh mesh;
  const auto level = [&](double share) { return Level{share * h, -.5 * l, .5 * l, .5 * w}; };
  addFrustum(mesh, level(.10), level(.36), Material::kPaint, Material::kPaint);
  addFrustum(mesh, level(.36), level(.76), Material::kGlass, Material::kPaint);
  addFrustum(mesh, level(.76), level(1), Material::kPaint, Material::kPaint);
  addWheels(mesh, wheels, .5 * w);
  return mesh;
}

Part limb(const Vector3& from, const Vector3& to, double radius, double swing, Material material) {
  Part part;
  addCylinder(part.mesh, from, to, radius, material, 1, 8);
  part.pivot = from;
  part.swing = swing;
  return part;
}

// Proportions of the standing body [drillis1966]: hip .53, shoulder .82, chin .87 of the height.
Shape pedestrianShape(double w, double h) {
  Shape shape;
  Part trunk;
  addCylinder(trunk.mesh, {0, 0, .50 * h}, {0, 0, .84 * h}, .40 * w, Material::kCloth, .6);
  addEllipsoid(trunk.mesh, {0, 0, .93 * h}, {.065 * h, .052 * h, .07 * h}, Material::kSkin);
  shape.parts.push_back(std::move(trunk));
  for (const double side : {-1.0, 1.0}) {
    constexpr double kLegSwing = 0.42, kArmSwing = 0.35;  // [rad] normal walking
    shape.parts.push_back(limb({0, side * .17 * w, .53 * h}, {0, side * .17 * w, 0}, .075,
                               side * kLegSwing, Material::kCloth));
    shape.parts.push_back(limb({0, side * .45 * w, .82 * h}, {0, side * .45 * w, .42 * h}, .045,
                               -side * kArmSwing, Material::kCloth));
  }
  shape.cycle = 1.45;  // [m] two steps of a walk at 1.4 m/s
  shape.full_pace = 1.2;
  return shape;
}

void addTire(Mesh& mesh, double x, double radius) {
  constexpr int kPieces = 12;
  const auto rim = [&](int k) {
    const double angle = kTwoPi * k / kPieces;
    return Vector3(x + radius * std::cos(angle), 0, radius * (1 + std::sin(angle)));
  };
  for (int k = 0; k < kPieces; ++k) {
    addCylinder(mesh, rim(k), rim(k + 1), .025, Material::kTire, 1, 5);
  }
}

// A rider on a bicycle: wheels as rims (spokes let the light through), frame, rider bent forward.
Shape cyclistShape(double l, double w, double h) {
  Shape shape;
  Part body;
  Mesh& mesh = body.mesh;
  const double radius = .19 * l, front = .5 * l - radius, rear = -front;
  addTire(mesh, front, radius);
  addTire(mesh, rear, radius);
  const Vector3 crank(-.05 * l, 0, .16 * h), seat(-.14 * l, 0, .52 * h), head(.24 * l, 0, .52 * h);
  for (const auto& [a, b] : {std::pair(crank, seat), std::pair(crank, head), std::pair(seat, head),
                             std::pair(Vector3(rear, 0, radius), crank),
                             std::pair(Vector3(front, 0, radius), Vector3(.22 * l, 0, .62 * h))}) {
    addCylinder(mesh, a, b, .02, Material::kMetal, 1, 6);
  }
  const Vector3 bar(.20 * l, 0, .62 * h), shoulder(.06 * l, 0, .84 * h);
  addCylinder(mesh, bar - Vector3(0, .45 * w, 0), bar + Vector3(0, .45 * w, 0), .02,
              Material::kMetal, 1, 6);
  addCylinder(mesh, seat + Vector3(0, 0, .02), shoulder, .17, Material::kCloth, .65);
  addEllipsoid(mesh, {.12 * l, 0, .93 * h}, {.11, .09, .07 * h}, Material::kSkin);
  for (const double side : {-1.0, 1.0}) {
    addCylinder(mesh, shoulder + Vector3(0, side * .18, 0), bar + Vector3(0, side * .4 * w, 0),
                .045, Material::kCloth, 1, 6);
  }
  shape.parts.push_back(std::move(body));
  for (const double side : {-1.0, 1.0}) {
    shape.parts.push_back(limb(seat + Vector3(0, side * .1, 0),
                               crank + Vector3(.08 * l, side * .1, -.05 * h), .07, side * .3,
                               Material::kCloth));
  }
  shape.cycle = 5;  // [m] one turn of the pedals in a middle gear
  shape.full_pace = 0.5;
  return shape;
}

// Leaves in an ellipsoid; beams pass between them.
Mesh bushMesh(const ObjectParams& o) {
  Mesh mesh;
  constexpr double kLeafSide = 0.12;  // [m] a tuft rather than one leaf
  const double per_area = 2.5;        // tufts' area over the ellipsoid's mean section
  const auto count = static_cast<std::uint32_t>(per_area * kPi / 4 * std::max(o.length, o.width) *
                                                o.height / (kLeafSide * kLeafSide));
  std::uint64_t seed = 1469598103934665603ull;  // FNV-1a of the name: the same bush in every run
  for (const char c : o.name) seed = (seed ^ static_cast<unsigned char>(c)) * 1099511628211ull;
  for (std::uint32_t i = 0; i < std::min(count, 4000u); ++i) {
    Rng rng({seed, 0, i, kLeafStream});
    Vector3 place(rng.normal(), rng.normal(), rng.normal());
    place *= std::cbrt(rng.uniform()) / place.norm();
    const Vector3 center = place.cwiseProduct(Vector3(.5 * o.length, .5 * o.width, .5 * o.height)) +
                           Vector3(0, 0, .5 * o.height);
    const Eigen::Matrix3d turn =
        makePose(0, 0, 0, rng.uniform(0, kTwoPi), std::asin(rng.uniform(-1, 1))).linear();
    const Vector3 u = turn.col(1) * (.5 * kLeafSide), v = turn.col(2) * (.5 * kLeafSide);
    addQuad(mesh, {center - u - v, center + u - v, center + u + v, center - u + v},
            Material::kLeaf);
  }
  return mesh;
}

Shape rigid(Mesh mesh) {
  Shape shape;
  shape.parts.resize(1);
  shape.parts[0].mesh = std::move(mesh);
  return shape;
}

}  // namespace

Wheels wheelsOf(const ObjectParams& o) {
  const double l = o.length, h = o.height;
  if (o.kind == ObjectKind::kCar) return {.31 * l, -.30 * l, .21 * h};
  if (o.kind == ObjectKind::kVan) return {.32 * l, -.30 * l, .16 * h};
  if (o.kind == ObjectKind::kBus) return {.28 * l, -.27 * l, .15 * h};
  return {};
}

Shape makeShape(const ObjectParams& o) {
  const double l = o.length, w = o.width, h = o.height;
  Mesh mesh;
  switch (o.kind) {
    case ObjectKind::kCar:
      return rigid(carMesh(l, w, h, wheelsOf(o)));
    case ObjectKind::kVan:
      return rigid(vanMesh(l, w, h, wheelsOf(o)));
    case ObjectKind::kBus:
      return rigid(busMesh(l, w, h, wheelsOf(o)));
    case ObjectKind::kCyclist:
      return cyclistShape(l, w, h);
    case ObjectKind::kPedestrian:
      return pedestrianShape(w, h);
    case ObjectKind::kPole:
      addCylinder(mesh, {0, 0, 0}, {0, 0, h}, .5 * w, Material::kMetal, l / w);
      return rigid(std::move(mesh));
    case ObjectKind::kBox:
      addFrustum(mesh, {0, -.5 * l, .5 * l, .5 * w}, {h, -.5 * l, .5 * l, .5 * w}, Material::kWall,
                 Material::kWall);
      return rigid(std::move(mesh));
    case ObjectKind::kBush:
      return rigid(bushMesh(o));
  }
  return {};
}

Pose3 partPose(const Shape& shape, const Part& part, double traveled, double speed) {
  if (part.swing == 0) return Pose3::Identity();
  const double pace = std::min(1.0, speed / shape.full_pace);
  const double angle = part.swing * pace * std::sin(kTwoPi * traveled / shape.cycle);
  Pose3 pose = Pose3::Identity();
  pose.linear() = Eigen::AngleAxisd(angle, Vector3::UnitY()).toRotationMatrix();
  pose.translation() = part.pivot - pose.linear() * part.pivot;
  return pose;
}

Mesh makeRoad(const Vector2& center, double half_side, double cell, double roughness) {
  Mesh mesh;
  const auto n = static_cast<std::uint32_t>(2 * std::ceil(half_side / cell)) + 1;
  const Vector2 corner = center - Vector2::Constant(cell * (n - 1) / 2);
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < n; ++j) {
      Rng rng({0, i, j, kRoadStream});
      addVertex(mesh, {corner.x() + cell * i, corner.y() + cell * j, roughness * rng.normal()});
    }
  }
  for (std::uint32_t i = 0; i + 1 < n; ++i) {
    for (std::uint32_t j = 0; j + 1 < n; ++j) {
      const std::uint32_t a = i * n + j, b = a + n;
      addTriangle(mesh, a, b, b + 1, Material::kRoad);
      addTriangle(mesh, a, b + 1, a + 1, Material::kRoad);
    }
  }
  return mesh;
}

}  // namespace perception
