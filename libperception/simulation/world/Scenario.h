#pragma once
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "libperception/config/Config.h"
#include "libperception/core/Frames.h"
#include "libperception/core/LaneMap.h"
#include "libperception/simulation/EgoSensors.h"
#include "libperception/simulation/RadarUnit.h"
#include "libperception/simulation/cameras/CameraBoxes.h"
#include "libperception/simulation/cameras/ImageCamera.h"
#include "libperception/simulation/cameras/SphericalCamera.h"
#include "libperception/simulation/lidar/LidarSensor.h"
#include "libperception/simulation/weather/SimulatedWeatherParams.h"
#include "libperception/simulation/world/Lighting.h"
#include "libperception/simulation/world/Trajectory.h"

namespace perception {

/// Kind of an object: determines shape, default size and truth type.
enum class ObjectKind { kCar, kVan, kBus, kCyclist, kPedestrian, kPole, kBox, kBush };

/// True for road users; poles, walls and bushes are surroundings.
bool isRoadUser(ObjectKind kind);
/// KITTI's type: Car, Van, Truck (a bus), Cyclist, Pedestrian, Misc.
const char* truthType(ObjectKind kind);

/// [scenario]: parameters of the log. Defaults assumed.
struct ScenarioParams {
  std::string description;
  double duration = 20;            ///< [s]
  double rate = 10;                ///< [1/s] rate of frame numbers in the log and of truth instants
  int start_utc = 1577836800;      ///< [s] since 1970, stamp of t = 0: 2020-01-01 (assumed)
  double ground_roughness = 0.01;  ///< [m] standard deviation of the road's height

  void visit(ParamVisitor& v);
};

/// Timed waypoints as lists of equal length, in [ego] and [object.NAME]. World frame, z up.
struct WaypointParams {
  std::vector<double> t;     ///< [s] since the log's first stamp
  std::vector<double> x, y;  ///< [m]
  double heading = 0;        ///< [rad] of an object at rest

  void visit(ParamVisitor& v);
  Trajectory trajectory() const { return {t, x, y, heading}; }
};

/// Simulated ego pose estimates, in [ego]; also in a vehicle INI. Errors assumed.
struct PoseParams {
  double rate = 100;        ///< [1/s] (100 Hz [radecki2016]); 0: the log holds no poses
  double sigma_xy = 0;      ///< [m] correlated error of the estimated pose
  double sigma_yaw = 0;     ///< [rad]
  double correlation = 10;  ///< [s] time constant of that error

  void visit(ParamVisitor& v);
};

/// [ego]: the vehicle with the sensors.
struct EgoParams {
  WaypointParams waypoints;  ///< of the ego origin: rear axle, on the ground
  PoseParams pose;

  void visit(ParamVisitor& v);
};

/// [road.NAME]: asphalt along a polyline; if there is any, the rest of the ground is grass. Width
/// assumed: two lanes.
struct RoadParams {
  std::string name;          ///< from the section's title
  std::vector<double> x, y;  ///< [m] center line
  double width = 7;          ///< [m]

  void visit(ParamVisitor& v);
};

/// [lane.NAME]: a lane of the lane map written with the log. Width assumed.
struct LaneSection {
  std::vector<double> x, y;  ///< [m] center line in driving direction, world
  double width = 3.5;        ///< [m]
  bool one_way = true;

  void visit(ParamVisitor& v);
};

/// [object.NAME]: one object of the scene. Default size: car (method.md 2.2).
struct ObjectParams {
  std::string name;  ///< from the section's title
  ObjectKind kind = ObjectKind::kCar;
  double length = 4.5, width = 1.8, height = 1.5;  ///< [m]
  double base = 0;                                 ///< [m] height of its bottom above the road
  double reflectivity = 1;  ///< factor on the reflectivity of its materials: < 1 for a dark car
  std::string
      party;  ///< objects of the same party get the same variation in a trial; "": own variation
  WaypointParams waypoints;  ///< of the footprint's center
  /// [s] in the scene from and to; not in an INI: objects of a recording come and go.
  double from = -std::numeric_limits<double>::infinity(),
         to = std::numeric_limits<double>::infinity();

  void visit(ParamVisitor& v);
};

enum class SensorKind {
  kLidar64,
  kLidar4,
  kCameraBoxes,
  kSphericalCamera,
  kCameraImages,
  kRadar,
  kGnss,
  kImu,
  kWheels
};

/// [sensor.LABEL]: one sensor of the vehicle. Defaults: KITTI's Velodyne [geiger2012].
struct SensorParams {
  std::string label;  ///< from the section's title
  SensorKind kind = SensorKind::kLidar64;
  double x = 0, y = 0, z = 1.73;  ///< [m] on the vehicle (KITTI's Velodyne: 1.73 m above the road)
  double yaw = 0, pitch = 0, roll = 0;  ///< [rad] of its forward axis; pitch > 0: down
  double rate = 10;                     ///< [1/s]
  double phase = 0;                     ///< [s] of its first scan
  LidarSensorParams lidar;
  CameraParams camera;
  SphericalCameraParams panorama;
  ImageCameraParams images;
  RadarUnitParams radar;
  GnssUnitParams gnss;
  ImuUnitParams imu;
  WheelUnitParams wheels;

  bool isLidar() const { return kind == SensorKind::kLidar64 || kind == SensorKind::kLidar4; }
  bool isCamera() const {
    return kind == SensorKind::kCameraBoxes || kind == SensorKind::kSphericalCamera ||
           kind == SensorKind::kCameraImages;
  }
  /// Measures ego motion only.
  bool isOfEgo() const {
    return kind == SensorKind::kGnss || kind == SensorKind::kImu || kind == SensorKind::kWheels;
  }
  /// For cameras.
  CameraModel cameraModel() const {
    if (kind == SensorKind::kCameraImages) return images.model();
    return kind == SensorKind::kSphericalCamera ? panorama.model() : camera.model();
  }
  /// Sensor frame (x forward, y left, z up; a camera's too) on the vehicle.
  Pose3 T_ego_sensor() const { return makePose(x, y, z, yaw, pitch, roll); }
  void visit(ParamVisitor& v);
};

/// [variation]: random differences of the trials of a scenario, drawn for each moving object,
/// uniform within +- these.
struct VariationParams {
  int trials = 1;    ///< number of trials; assumed: the unchanged scenario alone
  double start = 0;  ///< [s] of the start time
  double pace = 0;   ///< [-] relative speed, time scaled about t = 0
  double place = 0;  ///< [m] of the whole path, x and y

  void visit(ParamVisitor& v);
};

/// Contents of a scenario INI: scene, vehicle and sensors.
struct Scenario {
  ScenarioParams params;
  EgoParams ego;
  VariationParams variation;
  Lighting light;
  SimulatedWeatherParams weather;
  std::vector<RoadParams> roads;      ///< empty: asphalt everywhere
  std::vector<Lane> lanes;            ///< of the lane map
  std::vector<ObjectParams> objects;  ///< in the order of the file
  std::vector<SensorParams> sensors;
};

/// Reads all sections. Faults are collected in `config`; Config::finish() throws them.
Scenario readScenario(Config& config);
/// Reads the [sensor.LABEL] sections alone: a vehicle INI.
std::vector<SensorParams> readSensors(Config& config);

/// Trial 1, 2, ... of the scenario: paths of moving objects varied. Trial 0 is the unchanged
/// scenario.
Scenario trialOf(Scenario scenario, int trial, std::uint64_t seed);
/// Seed of a trial's sensors; trial 0 has `seed` itself.
std::uint64_t trialSeed(std::uint64_t seed, int trial);

}  // namespace perception
