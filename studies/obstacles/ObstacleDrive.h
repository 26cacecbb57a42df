#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "libperception/simulation/SimulatedWeather.h"
#include "libperception/simulation/lidar/LidarCaster.h"
#include "libperception/simulation/lidar/LidarSensor.h"
#include "libperception/simulation/world/Scenario.h"
#include "libperception/simulation/world/World.h"
#include "studies/obstacles/ObstacleShapes.h"

namespace perception {

/// How the vehicle comes up to a shape.
enum class DriveWay { kForward, kBackward, kLeft, kRight };
/// "forward", "backward", "left", "right", in the order of DriveWay.
const std::vector<std::string>& driveWayNames();

/// One drive towards a shape that stands on a flat road, at a steady speed.
struct ObstacleDriveParams {
  const ObstacleShape* shape = nullptr;
  int beams = 64;        ///< 16, 32, 64 or 128
  double speed = 10;     ///< [m/s]
  double distance = 50;  ///< [m] along the way from the ego origin to where the shape stands
  DriveWay way = DriveWay::kForward;
  double sector = 90;  ///< [deg] of the lidar's view, about the direction of travel
  std::string lidar;   ///< the sensor's label
  SimulatedWeatherParams weather;
  std::uint64_t seed = 1;
};

/// A lidar of that many beams: 16 as VLP-16, 32 as HDL-32E, 64 as HDL-64E, 128 evenly from -25 to
/// 15 deg (data sheets); .2 deg in azimuth, at 10 Hz. Throws Error (kUsage) for other numbers.
LidarSensorParams lidarOfBeams(int beams);

/// [1/m] of the arc: 3 m/s^2 across, and a radius of 25 m at least (assumed).
double curvatureOf(DriveWay way, double speed);

/// Scans of a drive, simulated one after the other and kept: the lidar on a car's roof, walls 9 m
/// to both sides, and in weather with a wet road cars that pass at 25 m/s in the next lane of a
/// straight road, for their spray.
class ObstacleDrive {
 public:
  static constexpr double kRate = 10;  ///< [1/s] of scans

  explicit ObstacleDrive(const ObstacleDriveParams& params);

  /// The vehicle at t [s]; the shape stands params.distance along its way.
  EgoState ego(double t) const;
  /// Scan number k, at t = k / kRate.
  const LidarSensor::Scan& scan(std::size_t k);
  Pose3 T_ego_lidar() const { return sensor_.T_ego_sensor(); }
  const std::string& lidar() const { return sensor_.label; }
  /// Whether a return of a scan is of the shape.
  bool isOfShape(const LidarSensor::Scan& scan, std::size_t i) const;
  /// Points of the shape's outline below `height` [m], 5 cm apart at most; world.
  std::vector<Vector3> outline(double height) const;

 private:
  Scenario scenario() const;
  Pose3 placeAt(double s) const;

  ObstacleDriveParams params_;
  double curvature_;
  SensorParams sensor_;
  World world_;
  LidarCaster caster_;
  LidarSensor lidar_;
  std::unique_ptr<SimulatedWeather> weather_;
  std::vector<LidarSensor::Scan> scans_;
};

}  // namespace perception
