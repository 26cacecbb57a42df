#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/simulation/world/Shape.h"

namespace perception {

class World;

/// First intersection of a beam with a surface.
struct BeamHit {
  static constexpr int kNothing = -2, kRoad = -1;
  static constexpr int kRecorded = 1 << 30;  ///< no object of the scenario: of a recording
  float range = 0;                           ///< [m]
  float cos_incidence = 0;                   ///< [0, 1] between beam and surface normal
  int object = kNothing;  ///< index into the scenario's objects, or one of the above
  Material material = Material::kRoad;
};

/// First intersection of a line of sight with a surface, for cameras.
struct SurfaceHit : BeamHit {
  Vector3 normal = Vector3::UnitZ();  ///< unit, world, towards the eye
};

/// Ray caster of a World (Embree). Results do not depend on the number of threads.
class LidarCaster {
 public:
  /// `threads` 0 = number of cores. The world must outlive it.
  explicit LidarCaster(const World& world, int threads = 1);
  ~LidarCaster();
  LidarCaster(const LidarCaster&) = delete;
  LidarCaster& operator=(const LidarCaster&) = delete;

  /// Sets the time t [s] of all objects.
  void setTime(double t);
  /// One hit for each direction (unit vectors, world) from `origin` [m], up to `range_max` [m].
  std::vector<BeamHit> cast(const Vector3& origin, const std::vector<Vector3>& directions,
                            double range_max) const;
  /// The surface in one direction (unit vector, world), for work that runs on the caster's threads.
  SurfaceHit surface(const Vector3& origin, const Vector3& direction, double range_max) const;
  /// Whether anything lies in that direction nearer than `range_max` [m].
  bool blocked(const Vector3& origin, const Vector3& direction, double range_max) const;
  /// Calls work(from, to) for pieces of [0, count) of about `grain`, on the caster's threads.
  void parallel(std::size_t count, std::size_t grain,
                const std::function<void(std::size_t from, std::size_t to)>& work) const;
  /// Unoccluded share of the object seen from `eye` [m, world], by solid angle.
  double visibleShare(const Vector3& eye, std::size_t object) const;

  const World& world() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace perception
