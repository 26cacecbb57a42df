#pragma once
#include <vector>

#include "libperception/core/GroundTruth.h"
#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/simulation/world/Scenario.h"
#include "libperception/simulation/world/Shape.h"

namespace perception {

/// One object at one instant.
struct ObjectState {
  Pose3 T_world_object = Pose3::Identity();  ///< center of the footprint, bottom, x along heading
  Vector2 velocity = Vector2::Zero();        ///< [m/s] world
  double traveled = 0;                       ///< [m]
  double yaw_rate = 0;                       ///< [rad/s]
};

/// States of all objects of a scenario as functions of t [s] since the log's first stamp.
class World {
 public:
  explicit World(Scenario scenario);

  const Scenario& scenario() const { return scenario_; }
  std::size_t objects() const { return shapes_.size(); }
  const Shape& shape(std::size_t object) const { return shapes_[object]; }
  const Mesh& road() const { return road_; }

  /// Stamp of t, a whole multiple of MRPT's 100 ns.
  Stamp stamp(double t) const;
  EgoState ego(double t) const;
  ObjectState object(std::size_t object, double t) const;
  bool present(std::size_t object, double t) const {
    const ObjectParams& o = scenario_.objects[object];
    return t >= o.from && t <= o.to;
  }
  /// Poses of the object's parts, world.
  std::vector<Pose3> parts(std::size_t object, double t) const;

  /// The geometric columns of the truth: all objects but walls (kind box); ids are 1 + index.
  /// occluded, truncated and lidar_points are set by the sensors.
  std::vector<TruthObject> truth(std::int64_t frame, double t) const;

 private:
  Scenario scenario_;
  Trajectory ego_;
  std::vector<Trajectory> trajectories_;
  std::vector<Shape> shapes_;
  Mesh road_;
};

}  // namespace perception
