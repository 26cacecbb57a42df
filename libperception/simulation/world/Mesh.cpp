#include "libperception/simulation/world/Mesh.h"

#include <cmath>

namespace perception {

std::uint32_t addVertex(Mesh& mesh, const Vector3& v) {
  mesh.vertices.push_back(
      {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())});
  return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
}

void addTriangle(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, Material material) {
  mesh.triangles.push_back({a, b, c});
  mesh.materials.push_back(material);
}

void addQuad(Mesh& mesh, const std::array<Vector3, 4>& corners, Material material) {
  std::array<std::uint32_t, 4> i{};
  for (std::size_t k = 0; k < 4; ++k) i[k] = addVertex(mesh, corners[k]);
  addTriangle(mesh, i[0], i[1], i[2], material);
  addTriangle(mesh, i[0], i[2], i[3], material);
}

void addFrustum(Mesh& mesh, const Level& low, const Level& high, Material side, Material top) {
  const auto corners = [](const Level& l) {
    return std::array<Vector3, 4>{
        Vector3(l.x0, -l.half_width, l.z), Vector3(l.x1, -l.half_width, l.z),
        Vector3(l.x1, l.half_width, l.z), Vector3(l.x0, l.half_width, l.z)};
  };
  const auto a = corners(low), b = corners(high);
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t next = (k + 1) % 4;
    addQuad(mesh, {a[k], a[next], b[next], b[k]}, side);
  }
  addQuad(mesh, b, top);
  addQuad(mesh, {a[3], a[2], a[1], a[0]}, top);
}

void addExtruded(Mesh& mesh, const std::vector<Vector2>& outline, double half_width,
                 Material material) {
  Vector2 middle = Vector2::Zero();
  for (const Vector2& p : outline) middle += p / static_cast<double>(outline.size());
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Vector2 &p = outline[k], &q = outline[(k + 1) % outline.size()];
    addQuad(mesh,
            {Vector3(p.x(), -half_width, p.y()), Vector3(q.x(), -half_width, q.y()),
             Vector3(q.x(), half_width, q.y()), Vector3(p.x(), half_width, p.y())},
            material);
    for (const double side : {-half_width, half_width}) {
      addTriangle(mesh, addVertex(mesh, {p.x(), side, p.y()}),
                  addVertex(mesh, {q.x(), side, q.y()}),
                  addVertex(mesh, {middle.x(), side, middle.y()}), material);
    }
  }
}

void addCylinder(Mesh& mesh, const Vector3& a, const Vector3& b, double radius, Material material,
                 double aspect, int sides) {
  const Vector3 axis = (b - a).normalized();
  const Vector3 across = std::abs(axis.y()) < 0.9 ? Vector3::UnitY() : Vector3::UnitZ();
  const Vector3 u = (across - axis * axis.dot(across)).normalized(), w = u.cross(axis);
  const auto rim = [&](const Vector3& center, int k) -> Vector3 {
    const double angle = kTwoPi * k / sides;
    return center + radius * (u * std::cos(angle) + aspect * w * std::sin(angle));
  };
  for (int k = 0; k < sides; ++k) {
    addQuad(mesh, {rim(a, k), rim(a, k + 1), rim(b, k + 1), rim(b, k)}, material);
    for (const Vector3& end : {a, b}) {
      addTriangle(mesh, addVertex(mesh, end), addVertex(mesh, rim(end, k)),
                  addVertex(mesh, rim(end, k + 1)), material);
    }
  }
}

void addEllipsoid(Mesh& mesh, const Vector3& center, const Vector3& half_axes, Material material) {
  constexpr int kAround = 10, kUp = 6;
  const auto point = [&](int i, int j) -> Vector3 {
    const double around = kTwoPi * i / kAround, up = kPi * j / kUp - kPi / 2;
    return center + half_axes.cwiseProduct(Vector3(std::cos(up) * std::cos(around),
                                                   std::cos(up) * std::sin(around), std::sin(up)));
  };
  for (int i = 0; i < kAround; ++i) {
    for (int j = 0; j < kUp; ++j) {
      addQuad(mesh, {point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)}, material);
    }
  }
}

}  // namespace perception
