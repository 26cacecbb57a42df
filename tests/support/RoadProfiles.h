#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/core/Time.h"
#include "libperception/measurement/frames/SensorFrame.h"
#include "tests/support/SyntheticCloud.h"

namespace perception::test {

/// A vertical curve: from the slope before it to `slope` over `length` (parabola of radius length /
/// change of slope); a straight where the slope stays.
struct RoadPiece {
  double length;  ///< [m]
  double slope;   ///< [-] at its end
};

/// A rounded bump across the road.
struct RoadBump {
  double at, length, height;  ///< [m] along the road of its middle, [m], [m]
};

/// A road along x, with all that lies beside and above it. Its first slope is that of piece 0.
struct RoadProfile {
  std::string name;
  std::vector<RoadPiece> pieces;
  double speed = 10;            ///< [m/s] at which it is driven
  double crossfall = 0;         ///< [-] slope across it
  double kerb = 0;              ///< [m] beyond 3.5 m to each side
  double pitch = 0;             ///< [rad] of the vehicle against the road, nose down
  std::vector<RoadBump> bumps;  ///< speed bumps
  std::vector<std::pair<double, double>> decks;  ///< [m] begin and end of bridges above it
  std::vector<RoadPiece> beside;                 ///< a second road beyond 4 m to the left, if any
};

/// Twenty roads: sags, crests, ramps, bumps, kerbs, bridges; radii of 300 to 50 m, and 20 m of
/// garage ramps; slopes to 15 %.
const std::vector<RoadProfile>& roadProfiles();

/// A profile's surface with what stands on it, for a simulated lidar. World frame: x along the
/// road, y to the left.
class Road {
 public:
  /// `reversed`: driven from its end.
  explicit Road(const RoadProfile& profile, bool reversed = false);

  double length() const { return length_; }   ///< [m]
  double heightAt(double x, double y) const;  ///< [m]
  /// The ego frame with its origin above x [m] of the road's middle, pitched by the wheels' chord.
  Pose3 vehicleAt(double x) const;
  /// The scan from there (simulated). Boxes in the world frame, their heights above the road.
  SensorFrame castFrom(double x, const SpinningLidar& lidar, const std::vector<SolidBox>& boxes,
                       Stamp stamp, std::uint64_t seed = 1) const;

 private:
  struct Table {
    std::vector<float> height;  ///< [m] in even steps, from before the road's begin on
    float at(float x) const;
  };
  static Table tabulate(const std::vector<RoadPiece>& pieces, double length, bool reversed);
  void addBumps();
  float surfaceAt(float x, float y) const;
  float rangeTo(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float far) const;

  RoadProfile profile_;
  double length_ = 0;
  bool reversed_;
  float steepest_ = 0;  ///< [-] of the tables
  Table road_, beside_;
  std::vector<SolidBox> decks_;
};

}  // namespace perception::test
