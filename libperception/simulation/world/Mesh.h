#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "libperception/core/Frames.h"

namespace perception {

/// Material of a surface, for its lidar reflectivity.
enum class Material : std::uint8_t {
  kRoad,
  kPaint,
  kGlass,
  kTire,
  kCloth,
  kSkin,
  kMetal,
  kWall,
  kLeaf,
  kGrass
};

/// A rigid surface of triangles. Single precision: the ray caster's.
struct Mesh {
  std::vector<std::array<float, 3>> vertices;           ///< [m]
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices of vertices
  std::vector<Material> materials;                      ///< one a triangle
};

/// A rectangle at height z: x from x0 to x1 [m], half width [m].
struct Level {
  double z, x0, x1, half_width;
};

// All lengths in [m], in the frame of the mesh.

/// Returns the new vertex's index.
std::uint32_t addVertex(Mesh& mesh, const Vector3& v);

/// A triangle of three existing vertices.
void addTriangle(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, Material material);

/// Two triangles between four corners, in cyclic order.
void addQuad(Mesh& mesh, const std::array<Vector3, 4>& corners, Material material);

/// The solid between two rectangles, as a cabin between belt line and roof.
void addFrustum(Mesh& mesh, const Level& low, const Level& high, Material side, Material top);

/// A side view (x, z) extruded along y; must be star-shaped about the mean of its corners.
void addExtruded(Mesh& mesh, const std::vector<Vector2>& outline, double half_width,
                 Material material);

/// A closed cylinder from a to b with elliptic section; `aspect` is its depth (x) over its width
/// (y) for upright ones.
void addCylinder(Mesh& mesh, const Vector3& a, const Vector3& b, double radius, Material material,
                 double aspect = 1, int sides = 10);

/// An ellipsoid along the axes.
void addEllipsoid(Mesh& mesh, const Vector3& center, const Vector3& half_axes, Material material);

}  // namespace perception
