#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libperception/config/Config.h"
#include "libperception/core/Frames.h"
#include "libperception/core/LaneMap.h"
#include "libperception/simulation/CameraBoxes.h"
#include "libperception/simulation/EgoSensors.h"
#include "libperception/simulation/LidarSensor.h"
#include "libperception/simulation/RadarUnit.h"
#include "libperception/simulation/SphericalCamera.h"
#include "libperception/simulation/Trajectory.h"

namespace perception {

/// What an object is; gives its shape, its usual size and its type in the truth.
enum class ObjectKind { kCar, kVan, kBus, kCyclist, kPedestrian, kPole, kBox, kBush };

/// True for road users; poles, walls and bushes are surroundings.
bool isRoadUser(ObjectKind kind);
/// KITTI's word: Car, Van, Truck (a bus), Cyclist, Pedestrian, Misc.
const char* truthType(ObjectKind kind);

/// [scenario]: what holds for the whole log. Defaults assumed.
struct ScenarioParams {
  std::string description;
  double duration = 20;            ///< [s]
  double rate = 10;                ///< [1/s] frames: numbers in the log and instants of the truth
  int start_utc = 1577836800;      ///< [s] since 1970, stamp of t = 0: 2020-01-01 (assumed)
  double ground_roughness = 0.01;  ///< [m] standard deviation of the road's height

  void visit(ParamVisitor& v);
};

/// Timed waypoints, as lists of one length: in [ego] and [object.NAME]. World, z up.
struct WaypointParams {
  std::vector<double> t;     ///< [s] since the log's first stamp
  std::vector<double> x, y;  ///< [m]
  double heading = 0;        ///< [rad] of what never moves

  void visit(ParamVisitor& v);
  Trajectory trajectory() const { return {t, x, y, heading}; }
};

/// The vehicle's pose estimator, in [ego]; the part of [ego] that a vehicle INI may hold. Errors
/// assumed.
struct PoseParams {
  double rate = 100;        ///< [1/s] (100 Hz [radecki2016]); 0: the log holds no poses
  double sigma_xy = 0;      ///< [m] error of the reported pose: slowly varying
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

/// [road.NAME]: asphalt along a line; with roads the rest of the ground is grass and pavement.
/// Width assumed: two lanes.
struct RoadParams {
  std::string name;          ///< from the section's title
  std::vector<double> x, y;  ///< [m] middle line
  double width = 7;          ///< [m]

  void visit(ParamVisitor& v);
};

/// [lane.NAME]: a lane of a road, for the map that goes with the log. Width
/// assumed.
struct LaneSection {
  std::vector<double> x, y;  ///< [m] center line in driving direction, world
  double width = 3.5;        ///< [m]
  bool one_way = true;

  void visit(ParamVisitor& v);
};

/// [object.NAME]: one thing of the scene. Size of a car (method.md 2.2).
struct ObjectParams {
  std::string name;  ///< from the section's title
  ObjectKind kind = ObjectKind::kCar;
  double length = 4.5, width = 1.8, height = 1.5;  ///< [m]
  double base = 0;                                 ///< [m] height of its bottom above the road
  double reflectivity = 1;   ///< times the usual one of its materials: below 1 a dark car
  std::string party;         ///< objects of one name vary together from trial to trial; "": alone
  WaypointParams waypoints;  ///< of the footprint's center

  void visit(ParamVisitor& v);
};

enum class SensorKind {
  kLidar64,
  kLidar4,
  kCameraBoxes,
  kSphericalCamera,
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
  double yaw = 0, pitch = 0, roll = 0;  ///< [rad] of its forward axis; pitch > 0 looks down
  double rate = 10;                     ///< [1/s]
  double phase = 0;                     ///< [s] of its first scan
  LidarParams lidar;
  CameraParams camera;
  SphericalCameraParams panorama;
  RadarUnitParams radar;
  GnssUnitParams gnss;
  ImuUnitParams imu;
  WheelUnitParams wheels;

  bool isLidar() const { return kind == SensorKind::kLidar64 || kind == SensorKind::kLidar4; }
  bool isCamera() const {
    return kind == SensorKind::kCameraBoxes || kind == SensorKind::kSphericalCamera;
  }
  /// Of the vehicle's own motion: sees nothing around it.
  bool isOfEgo() const {
    return kind == SensorKind::kGnss || kind == SensorKind::kImu || kind == SensorKind::kWheels;
  }
  /// Of a camera.
  CameraModel cameraModel() const {
    return kind == SensorKind::kSphericalCamera ? panorama.model() : camera.model();
  }
  /// Sensor frame (x forward, y left, z up; a camera's too) on the vehicle.
  Pose3 T_ego_sensor() const { return makePose(x, y, z, yaw, pitch, roll); }
  void visit(ParamVisitor& v);
};

/// [variation]: how the trials of one scenario differ. Each mover draws its own values, uniform
/// within +- these; what never moves stays.
struct VariationParams {
  int trials = 1;    ///< how many there are; assumed: the scenario as it is written
  double start = 0;  ///< [s] earlier or later
  double pace = 0;   ///< [-] faster or slower, about t = 0
  double place = 0;  ///< [m] of the whole way, x and y

  void visit(ParamVisitor& v);
};

/// A scene, its vehicle and its sensors as data: the scenario INI.
struct Scenario {
  ScenarioParams params;
  EgoParams ego;
  VariationParams variation;
  std::vector<RoadParams> roads;      ///< none: asphalt everywhere
  std::vector<Lane> lanes;            ///< that the log's map shows
  std::vector<ObjectParams> objects;  ///< in the order of the file
  std::vector<SensorParams> sensors;
};

/// Reads all sections; faults go to `config`, whose finish() throws them.
Scenario readScenario(Config& config);
/// Reads the [sensor.LABEL] sections alone: a vehicle INI.
std::vector<SensorParams> readSensors(Config& config);

/// Trial 1, 2, ... of the scenario: its movers' ways varied. Trial 0 is the file as it stands.
Scenario trialOf(Scenario scenario, int trial, std::uint64_t seed);
/// Seed of a trial's sensors; trial 0 has `seed` itself.
std::uint64_t trialSeed(std::uint64_t seed, int trial);

}  // namespace perception
