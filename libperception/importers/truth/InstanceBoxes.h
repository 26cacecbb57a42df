#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/core/Time.h"

namespace perception {

/// What was seen of an object on the ground plane: how far it reaches in each of 180 directions.
class SeenOutline {
 public:
  static constexpr std::size_t kDirections = 180;

  void add(const Vector3& point);
  void add(const SeenOutline& other);
  std::size_t points() const { return points_; }
  Vector2 mean() const { return sum_ / static_cast<double>(points_); }
  double bottom() const { return bottom_; }
  double top() const { return top_; }
  /// [m] how far it reaches along an angle [rad], to the next of the directions.
  double reach(double angle) const;
  double widthAlong(double angle) const { return reach(angle) + reach(angle + kPi); }
  /// [rad] of the longer side of the least rectangle about it.
  double longSide() const;

 private:
  std::array<float, kDirections> reach_ = filled();
  Vector2 sum_ = Vector2::Zero();
  double bottom_ = std::numeric_limits<double>::infinity(), top_ = -bottom_;
  std::size_t points_ = 0;

  static std::array<float, kDirections> filled();
};

/// Boxes of objects whose points are labeled scan by scan, fitted about their returns. A standing
/// object gets one box about the returns of all scans. A moving one gets a box in the direction of
/// its motion, with the largest extents that were seen, aligned with the side that the sensor sees.
/// Extents are those of the part that was seen, not of the whole object.
class InstanceBoxes {
 public:
  /// A return of an object; `moves`: the label says that the object moves.
  void add(std::int64_t id, bool moves, const std::string& type, std::int64_t frame, Stamp stamp,
           const Vector2& sensor, const Vector3& world);
  struct Row {
    Stamp stamp;
    TruthObject object;
  };
  /// A row for each scan in which it has five returns or more.
  std::vector<Row> rows() const;

 private:
  struct Sighting {
    Stamp stamp;
    Vector2 sensor = Vector2::Zero();
    SeenOutline outline;
  };
  struct Instance {
    bool moves = false;
    std::string type;
    std::map<std::int64_t, Sighting> sightings;  ///< by frame
  };
  static std::vector<double> headingsOf(const Instance& instance);
  std::map<std::int64_t, Instance> instances_;
};

}  // namespace perception
