#pragma once
#include <mrpt/obs/CObservation.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libperception/doctor/motion/MotionCheck.h"
#include "libperception/lidar/ground/GroundPlane.h"
#include "libperception/measurement/frames/LidarInputs.h"
#include "libperception/odometry/LidarOdometry.h"
#include "libperception/pipeline/input/LogContents.h"
#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/sensors/satellites/GnssFix.h"

namespace perception {

/// What the frames of one sensor label hold.
struct SensorFacts {
  /// As [sensor.LABEL] kind (lidar, boxes, positions, radar), or "image".
  std::string kind;
  bool planar = false;  ///< a lidar of one layer: all of its returns lie in one plane
  std::uint64_t frames = 0, unusable = 0;
  DecodeCounts counts;
  std::vector<Stamp> stamps;               ///< of usable frames
  Pose3 T_ego_sensor = Pose3::Identity();  ///< of the first frame
  bool pose_varies = false;                ///< over the log
  std::optional<Stamp> newest;
  std::uint64_t backward = 0;    ///< frames with an earlier stamp than the newest before
  double farthest_back = 0;      ///< [s] of these, at most
  std::uint64_t timeless = 0;    ///< scans with times outside of them (ScanTimes.h)
  std::uint64_t no_returns = 0;  ///< points by NoReturns.h

  std::uint64_t returns = 0;                   ///< or boxes
  std::vector<std::uint64_t> ranges;           ///< number of returns by horizontal range, 1 m bins
  std::vector<std::uint64_t> bearings;         ///< the same by |bearing|, bins of 1 deg
  double farthest_bearing = 0;                 ///< [rad] of radars and cameras
  std::optional<double> low, high;             ///< least and largest intensity or score
  std::optional<LidarInputs> inputs;           ///< of a lidar's first scan
  std::map<std::string, std::uint64_t> names;  ///< the detector's class names
  std::vector<GroundPlane> planes;             ///< of single scans, ego frame
  std::vector<EgoState> odometry;              ///< of a lidar: the vehicle's poses by its scans
  std::vector<SensorVelocity> velocities;      ///< of a radar
  std::vector<CameraMotion> camera_motions;    ///< of images
  std::uint64_t unread_images = 0;             ///< without a file, or damaged

  /// [m] below which a share of the returns lies, rounded up to 1 m; 0 without returns.
  double rangeBelow(double share) const;
  /// [rad] about the forward axis, both sides, that holds a share of the returns.
  double angleOf(double share) const;
  double longestGap() const;  ///< [s] between two frames
  double rate() const;        ///< [Hz] median; 0 with less than two frames
};

/// Mounting of a lidar as the ground shows it: medians over the scans (method.md 8.11).
struct GroundMounting {
  double height = 0, pitch = 0, roll = 0;  ///< [m, rad, rad] of the sensor above the ground plane
  /// [m, rad, rad] by which the log's mounting differs from it; angles about the vehicle's axes.
  double height_error = 0, pitch_error = 0, roll_error = 0;
  double spread = 0;  ///< [rad] median deviation of the scans' pitch from the median
  std::size_t scans = 0;
  GroundPlane plane;  ///< median, ego frame of the log
  Pose3 T_ego_sensor =
      Pose3::Identity();  ///< the log's, turned and lifted so that the ground is z = 0
  bool steady() const;    ///< the scans agree: what they show is the ground
  /// Steady, and larger than what a crowned road or a loaded trunk explains.
  bool wrong() const;
};
/// Empty with less than three scans that show the ground.
std::optional<GroundMounting> groundMounting(const SensorFacts& facts);

/// A log as perception-doctor sees it: call look() with every observation.
class LogSurvey {
 public:
  /// `images`: folder of external images.
  explicit LogSurvey(std::string images = "") : images_(std::move(images)) {}
  void look(const mrpt::obs::CObservation& observation);

  const LogContents& contents() const { return contents_; }
  const std::map<std::string, SensorFacts>& sensors() const { return sensors_; }
  /// Poses of the log by label, in order of arrival.
  const std::map<std::string, std::vector<EgoState>>& poses() const { return poses_; }
  /// Numbers of GNSS, inertial and wheel observations by class name.
  const std::map<std::string, std::uint64_t>& motion() const { return motion_; }
  const std::optional<SensorFrame>& sample() const { return sample_; }  ///< a scan, for pictures
  std::uint64_t poseFaults() const { return pose_faults_; }  ///< not finite or without stamp
  /// Poses with which mountings and clocks are compared, chosen as [ego] does: EGO_POSE, or the
  /// first label; null if the log has none.
  const std::vector<EgoState>* referencePoses() const;
  /// Mounting and clock of a lidar, radar or camera against these poses.
  std::optional<MotionCheck> motionCheck(const SensorFacts& facts) const;
  /// Positions of a GNSS receiver of the log.
  struct GnssFacts {
    std::optional<LocalFrame> frame;    ///< east and north of the first fix
    Vector2 antenna = Vector2::Zero();  ///< [m] vehicle frame
    std::vector<AntennaPlace> fixes;
  };
  const std::map<std::string, GnssFacts>& gnss() const { return gnss_; }

 private:
  void lookAt(SensorFacts& facts, const SensorFrame& frame);
  void lookAtGnss(const mrpt::obs::CObservationGPS& observation);
  void follow(SensorFacts& facts, const SensorFrame& frame);
  void lookAtImage(SensorFacts& facts, const SensorFrame& frame);

  LogContents contents_;
  std::map<std::string, SensorFacts> sensors_;
  std::map<std::string, std::vector<EgoState>> poses_;
  std::map<std::string, std::uint64_t> motion_;
  std::map<std::string, GnssFacts> gnss_;
  std::map<std::string, LidarOdometry> odometry_;
  std::map<std::string, ImageMotion> image_motion_;
  std::string images_;
  std::string first_pose_label_;
  std::optional<SensorFrame> sample_;
  std::uint64_t pose_faults_ = 0;
};

}  // namespace perception
