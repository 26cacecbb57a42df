#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

// The tables of an aiMotive recording. Times: [s] from its first frame. Body frame: x forward, y
// left, z up, origin on the ground. All readers throw DataError: kNoInput when the file is missing,
// else with file, line and what was expected.

/// calib.json: poses of the sensors in the body frame, and the front camera.
struct AimotiveCalibration {
  Pose3 T_body_lidar = Pose3::Identity();
  Pose3 T_body_radar_front = Pose3::Identity(), T_body_radar_rear = Pose3::Identity();
  Pose3 T_body_camera = Pose3::Identity();  ///< optical: x right, y down, z forward
  CameraModel camera;
  std::vector<double> distortion;  ///< k1 k2 p1 p2 k3
};
AimotiveCalibration readAimotiveCalibration(const std::string& path);

/// One turn of the lidar: scans.csv. It begins behind the vehicle and goes clockwise.
struct AimotiveTurn {
  std::int64_t number = 0;
  double start = 0, end = 0;  ///< [s]
  std::uint64_t points = 0;

  double middle() const { return (start + end) / 2; }  ///< when it looks ahead
  /// [s] at which a direction was scanned, `azimuth` [rad] about the lidar, counter-clockwise off
  /// the body's x axis.
  double timeOf(double azimuth) const { return start + (kPi - azimuth) / kTwoPi * (end - start); }
};
std::vector<AimotiveTurn> readAimotiveTurns(const std::string& path);

/// The vehicle's way: ego.csv integrated. World: the body frame at the first row.
class AimotiveEgo {
 public:
  struct State {
    double t = 0;
    Vector2 velocity = Vector2::Zero();  ///< [m/s] body frame
    double yaw_rate = 0;                 ///< [rad/s]
    Pose3 T_world_body = Pose3::Identity();
  };
  explicit AimotiveEgo(const std::string& path);

  const std::vector<State>& states() const { return states_; }
  /// Linearly between two rows, with the motion of the first or last one beyond them.
  State at(double t) const;

 private:
  std::vector<State> states_;  ///< by time, at least one
};

/// A row of boxes.csv.
struct AimotiveBox {
  double t = 0;
  std::string type;                             ///< of the truth
  ObjectDetection::SpaceBox box;                ///< body frame
  Vector2 relative_velocity = Vector2::Zero();  ///< [m/s] change of the place in the body frame
  int occluded = 0;
  double truncated = 0;
};
/// By object, each in order of time.
std::map<std::int64_t, std::vector<AimotiveBox>> readAimotiveBoxes(const std::string& path);

/// The object's box at a time: between its neighbors, or moved by its velocity for at most 0.1 s
/// beyond them (three frames come in 0.2 s). Empty: the object is not labeled there.
std::optional<AimotiveBox> boxAt(const std::vector<AimotiveBox>& rows, double t);

/// Targets of a radar by frame: radar_front.csv, radar_rear.csv.
struct AimotiveRadarScan {
  std::int64_t frame = 0;
  double t = 0;
  RadarReturns returns;
};
std::vector<AimotiveRadarScan> readAimotiveRadar(const std::string& path);

/// A row of frames.csv: the instant of cameras and radars.
struct AimotiveFrame {
  std::int64_t frame = 0;
  double t = 0;
};
std::vector<AimotiveFrame> readAimotiveFrames(const std::string& path);

}  // namespace perception
