#pragma once
#include <cstdint>
#include <deque>
#include <limits>
#include <string>
#include <vector>

#include "libperception/core/GroundTruth.h"
#include "libperception/core/Time.h"
#include "libperception/grid/way/StopAdvice.h"
#include "libperception/measurement/frames/PlacedReturns.h"
#include "studies/obstacles/StopCount.h"

namespace perception {

/// The obstacle returns of one labeled scan.
struct LabeledObstacles {
  std::vector<Vector3> place;          ///< [m] world
  std::vector<float> x, y, z;          ///< [m] ego frame
  std::vector<bool> phantom, surface;  ///< neither: road
};

/// Those within the slab of obstacles; `labels` of the cloud's points.
LabeledObstacles obstaclesOf(const PlacedReturns& returns, const Pose3& T_world_ego,
                             const std::vector<std::uint16_t>& labels);

/// The nearest thing in a corridor.
struct Ahead {
  double s = std::numeric_limits<double>::infinity();  ///< [m] along the arc; infinity: nothing
  Vector3 place = Vector3::Zero();                     ///< [m] world
};

/// Speeds of what stands in a truth file, by place.
class TruthSpeeds {
 public:
  /// Of LOG.truth.csv; without such a file everything stands still.
  explicit TruthSpeeds(const std::string& rawlog);
  /// [m/s] of the object at the place; 0: none there, or unknown. `t` [s] since the log's first
  /// stamp.
  Vector2 at(double t, const Vector3& place) const;

 private:
  GroundTruth truth_;
};

/// The stopping rule at one instant.
struct StopRule {
  Corridor corridor;
  StopParams params;
  double t = 0;      ///< [s] since the log's first stamp
  double speed = 0;  ///< [m/s] own
  const TruthSpeeds* speeds = nullptr;

  /// [m] by which an obstacle is within the distance that its velocity [m/s] asks for; negative:
  /// beyond.
  double within(const Ahead& obstacle, const Vector2& velocity) const;
  /// The velocity is that of the truth.
  double within(const Ahead& obstacle) const;
};

/// What is really in the driven path, by the labels of the returns of the last half second.
class WayTruth {
 public:
  /// `t` [s] since the log's first stamp.
  void add(Stamp stamp, double t, const LabeledObstacles& obstacles, const TruthSpeeds& speeds);
  /// Call once for every scan, after add().
  InTheWay judge(Stamp stamp, const StopRule& rule);

 private:
  struct Scan {
    Stamp stamp;
    std::vector<Vector3> places;      ///< of surfaces, world
    std::vector<Vector2> velocities;  ///< [m/s] of what they belonged to
  };
  std::deque<Scan> scans_;
  int sure_scans_ = 0;  ///< in a row in which something is clearly in the way
};

/// The nearest three returns of a scan within half a meter.
Ahead nearestInCorridor(const std::vector<Vector3>& places, const Corridor& corridor);
/// The nearest return in the corridor of a Euclidean cluster (ten returns, linked at .7 m, in
/// space; assumed: what open stacks start with).
Ahead nearestCluster(const LabeledObstacles& obstacles, const Corridor& corridor);

}  // namespace perception
