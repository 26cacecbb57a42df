#include "libperception/doctor/LogSurvey.h"

#include <mrpt/obs/CObservationGPS.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRobotPose.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "libperception/core/math/Median.h"
#include "libperception/measurement/frames/NoReturns.h"
#include "libperception/measurement/frames/ScanTimes.h"
#include "libperception/sensors/observations/Conversions.h"

namespace perception {
namespace {

constexpr std::size_t kRangeBins = 400, kBearingBins = 181;
/// Labels of a damaged log may be anything: memory is bounded.
constexpr std::size_t kMostLabels = 200;
/// Scans of a lidar that odometry follows: minutes show its mounting, and each costs 10 to 90 ms.
constexpr std::size_t kMostFollowed = 2000;
constexpr std::size_t kMostFixes = 20000;  ///< half an hour at 10 Hz
/// [rad], [m] A mounting this far off costs the tracks more than the ground estimator corrects:
/// its planes are bounded at 5 deg and .3 m about the vehicle's frame (method.md 8.1).
constexpr double kWrongTilt = radians(1), kWrongHeight = 0.1;

/// [rad] Planes that differ more from scan to scan are not of a road: a scanner with few layers
/// sees little of it.
constexpr double kSteady = radians(0.5);

/// A plane at any height and tilt that a lidar on a vehicle may have by mistake.
GroundParams searchEverywhere() {
  GroundParams params;
  params.max_offset = 6;
  params.max_tilt = radians(20);
  params.wet_share = 1;  // without a former plane nothing is mirrored
  return params;
}

void extend(SensorFacts& facts, double value) {
  if (!std::isfinite(value)) return;
  facts.low = std::min(facts.low.value_or(value), value);
  facts.high = std::max(facts.high.value_or(value), value);
}

void addStamp(SensorFacts& facts, Stamp stamp) {
  const double back = facts.newest ? *facts.newest - stamp : 0;
  facts.backward += back > 0;
  facts.farthest_back = std::max(facts.farthest_back, back);
  if (!facts.newest || stamp > *facts.newest) facts.newest = stamp;
  facts.stamps.push_back(stamp);
}

void addReturn(SensorFacts& facts, double range, double bearing) {
  ++facts.returns;
  facts.ranges.resize(kRangeBins);
  facts.bearings.resize(kBearingBins);
  ++facts.ranges[std::min(kRangeBins - 1, static_cast<std::size_t>(range))];
  ++facts.bearings[static_cast<std::size_t>(degrees(std::abs(bearing)))];
  facts.farthest_bearing = std::max(facts.farthest_bearing, std::abs(bearing));
}

/// Whether all returns lie in the plane of the sensor's x and y, as those of a laser scanner.
bool isOneLayer(const LidarCloud& cloud) {
  return std::all_of(cloud.z.begin(), cloud.z.end(), [](float z) { return std::abs(z) < 1e-3F; });
}

void addCloud(SensorFacts& facts, const LidarCloud& cloud) {
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto x = static_cast<double>(cloud.x[i]), y = static_cast<double>(cloud.y[i]);
    addReturn(facts, std::hypot(x, y), std::atan2(y, x));
  }
  for (const float v : cloud.intensity) extend(facts, static_cast<double>(v));
}

void addBoxes(SensorFacts& facts, const ObjectDetections& boxes) {
  const CameraModel& camera = boxes.camera;
  if (camera.fx > 0 && camera.projection == CameraModel::Projection::kPinhole) {
    facts.farthest_bearing =
        std::max(facts.farthest_bearing,
                 std::atan(std::max(camera.cx, camera.width - camera.cx) / camera.fx));
  } else if (camera.fx > 0) {
    facts.farthest_bearing = kPi;
  }
  for (const ObjectDetection& object : boxes.objects) {
    ++facts.returns;
    if (facts.names.size() < kMostLabels) ++facts.names[object.label];
    extend(facts, object.score);
    if (object.space_box && !object.image_box) facts.kind = "positions";
    if (!object.space_box) continue;
    const Vector3& at = object.space_box->bottom_center;
    --facts.returns;
    addReturn(facts, at.head<2>().norm(), std::atan2(at.y(), at.x()));
  }
}

double valueAt(const std::vector<std::uint64_t>& bins, double share) {
  std::uint64_t all = 0, sum = 0;
  for (const auto n : bins) all += n;
  if (all == 0) return 0;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    sum += bins[i];
    if (static_cast<double>(sum) >= share * static_cast<double>(all))
      return static_cast<double>(i + 1);
  }
  return static_cast<double>(bins.size());
}

std::vector<double> steps(const std::vector<Stamp>& stamps) {
  std::vector<Stamp> sorted = stamps;
  std::sort(sorted.begin(), sorted.end());
  std::vector<double> out;
  for (std::size_t i = 1; i < sorted.size(); ++i) out.push_back(sorted[i] - sorted[i - 1]);
  return out;
}

}  // namespace

double SensorFacts::rangeBelow(double share) const { return valueAt(ranges, share); }
double SensorFacts::angleOf(double share) const { return radians(2 * valueAt(bearings, share)); }

double SensorFacts::longestGap() const {
  const auto all = steps(stamps);
  return all.empty() ? 0 : *std::max_element(all.begin(), all.end());
}

double SensorFacts::rate() const {
  const auto all = steps(stamps);
  const double median = all.empty() ? 0 : medianOf(all);
  return median > 0 ? 1 / median : 0;
}

bool GroundMounting::steady() const { return spread < kSteady; }

bool GroundMounting::wrong() const {
  if (!steady()) return false;
  return std::abs(pitch_error) > kWrongTilt || std::abs(roll_error) > kWrongTilt ||
         std::abs(height_error) > kWrongHeight;
}

std::optional<GroundMounting> groundMounting(const SensorFacts& facts) {
  if (facts.planes.size() < 3) return std::nullopt;
  const auto median = [&](double GroundPlane::*value) {
    std::vector<double> values;
    for (const auto& plane : facts.planes) values.push_back(plane.*value);
    return medianOf(std::move(values));
  };
  const double a = median(&GroundPlane::a), b = median(&GroundPlane::b),
               c = median(&GroundPlane::c);
  std::vector<double> deviations;
  for (const auto& plane : facts.planes) deviations.push_back(std::abs(plane.a - a));
  GroundMounting m;
  m.scans = facts.planes.size();
  m.plane = {a, b, c, facts.planes.back().sigma, true};
  m.spread = medianOf(std::move(deviations));
  // Turns the plane's normal upright and lifts the plane to z = 0 at the ego origin.
  const Vector3 normal = Vector3(-a, -b, 1).normalized();
  Pose3 T_level_ego = Pose3::Identity();
  T_level_ego.linear() =
      Eigen::Quaterniond::FromTwoVectors(normal, Vector3::UnitZ()).toRotationMatrix();
  T_level_ego.translation() = -(T_level_ego.linear() * Vector3(0, 0, c));
  m.T_ego_sensor = T_level_ego * facts.T_ego_sensor;
  m.T_ego_sensor.translation().head<2>() = facts.T_ego_sensor.translation().head<2>();
  m.height = m.T_ego_sensor.translation().z();
  m.pitch = pitchOf(m.T_ego_sensor), m.roll = rollOf(m.T_ego_sensor);
  m.height_error = facts.T_ego_sensor.translation().z() - m.height;
  const Pose3 error = T_level_ego.inverse();  // log's mounting = error * true mounting
  m.pitch_error = pitchOf(error), m.roll_error = rollOf(error);
  return m;
}

void LogSurvey::lookAt(SensorFacts& facts, const SensorFrame& frame) {
  if (facts.frames == 0) facts.T_ego_sensor = frame.T_ego_sensor;
  facts.pose_varies = facts.pose_varies || !facts.T_ego_sensor.isApprox(frame.T_ego_sensor, 1e-3);
  ++facts.frames;
  addStamp(facts, frame.stamp);
  if (const auto* cloud = std::get_if<LidarCloud>(&frame.data)) {
    facts.kind = "lidar";
    if (!facts.inputs && cloud->size() > 0) facts.inputs = LidarInputs::of(*cloud);
    if (cloud->size() > 0)
      facts.planar = (facts.returns == 0 || facts.planar) && isOneLayer(*cloud);
    addCloud(facts, *cloud);
    facts.timeless += timesOutsideOf(*cloud);
    facts.no_returns += noReturnsOf(*cloud).points.size();
    const GroundPlane plane = GroundEstimator(searchEverywhere()).update(frame);
    if (plane.measured) facts.planes.push_back(plane);
    if (!facts.planar) follow(facts, frame);
    if (!sample_ || sample_->sensor == frame.sensor) sample_ = frame;
  } else if (const auto* boxes = std::get_if<ObjectDetections>(&frame.data)) {
    if (facts.kind.empty()) facts.kind = "boxes";
    addBoxes(facts, *boxes);
  } else if (const auto* radar = std::get_if<RadarReturns>(&frame.data)) {
    facts.kind = "radar";
    for (const auto& r : radar->returns) addReturn(facts, r.range, r.bearing);
    if (const auto v = radarVelocity(*radar, frame.stamp)) facts.velocities.push_back(*v);
  } else {
    facts.kind = "image";
    lookAtImage(facts, frame);
  }
}

void LogSurvey::follow(SensorFacts& facts, const SensorFrame& frame) {
  if (facts.pose_varies || facts.odometry.size() >= kMostFollowed) return;
  EgoState state;
  state.stamp = frame.stamp;
  if (const auto pose = odometry_[frame.sensor].update(frame)) {
    state.T_world_ego = *pose;
    facts.odometry.push_back(state);
  }
}

void LogSurvey::lookAtImage(SensorFacts& facts, const SensorFrame& frame) {
  if (facts.pose_varies || facts.camera_motions.size() >= kMostFollowed) return;
  const auto& image = std::get<CameraImage>(frame.data);
  const auto raster = image.load();
  if (!raster) ++facts.unread_images;
  const bool pinhole = image.camera.fx > 0 &&
                       (image.camera.width == 0 || (raster && image.camera.width == raster->width));
  if (!raster || !pinhole) return;
  if (const auto motion = image_motion_[frame.sensor].update(image.camera, *raster, frame.stamp))
    facts.camera_motions.push_back(*motion);
}

const std::vector<EgoState>* LogSurvey::referencePoses() const {
  const auto named = poses_.find("EGO_POSE");
  if (named != poses_.end()) return &named->second;
  const auto first = poses_.find(first_pose_label_);
  return first == poses_.end() ? nullptr : &first->second;
}

std::optional<MotionCheck> LogSurvey::motionCheck(const SensorFacts& facts) const {
  const auto* poses = referencePoses();
  if (poses == nullptr || facts.pose_varies) return std::nullopt;
  if (facts.kind == "radar") return checkRadarMotion(facts.velocities, facts.T_ego_sensor, *poses);
  if (facts.kind == "image")
    return checkImageMotion(facts.camera_motions, facts.T_ego_sensor, *poses);
  auto check = checkLidarMotion(facts.odometry, facts.T_ego_sensor, *poses);
  const auto ground = groundMounting(facts);
  if (check && ground && ground->steady())  // where both disagree, odometry climbs or sinks
    check->pitch.sigma = std::hypot(check->pitch.sigma, check->pitch.error - ground->pitch_error);
  return check;
}

void LogSurvey::lookAtGnss(const mrpt::obs::CObservationGPS& observation) {
  const auto fix = gnssFix(observation, {});
  const std::string& label = observation.sensorLabel;
  if (!fix || (gnss_.size() >= kMostLabels && gnss_.count(label) == 0)) return;
  GnssFacts& facts = gnss_[label];
  if (facts.fixes.size() >= kMostFixes) return;
  if (!facts.frame) facts.frame.emplace(fix->place), facts.antenna = fix->antenna.head<2>();
  facts.fixes.push_back({fix->stamp, facts.frame->fromGeodetic(fix->place).head<2>()});
}

void LogSurvey::look(const mrpt::obs::CObservation& observation) {
  using namespace mrpt::obs;
  contents_.look(observation);
  const std::string& label = observation.sensorLabel;
  if (const auto* pose = dynamic_cast<const CObservationRobotPose*>(&observation)) {
    EgoState state;
    const auto stamp = toStamp(pose->timestamp);
    state.T_world_ego = toPose3(pose->pose.mean);
    const bool usable = stamp && state.T_world_ego.matrix().allFinite();
    if (!usable) ++pose_faults_;
    if (!usable || (poses_.size() >= kMostLabels && poses_.count(label) == 0)) return;
    state.stamp = *stamp;
    if (poses_.empty()) first_pose_label_ = label;
    poses_[label].push_back(state);
  } else if (const auto* gnss = dynamic_cast<const CObservationGPS*>(&observation)) {
    ++motion_["GNSS"];
    lookAtGnss(*gnss);
  } else if (dynamic_cast<const CObservationIMU*>(&observation) != nullptr) {
    ++motion_["inertial unit"];
  } else if (dynamic_cast<const CObservationOdometry*>(&observation) != nullptr) {
    ++motion_["wheels"];
  } else if (isSensorData(observation)) {
    if (sensors_.size() >= kMostLabels && sensors_.count(label) == 0) return;
    SensorFacts& facts = sensors_[label];
    if (const auto frame = frameFromObservation(observation, &facts.counts, images_)) {
      lookAt(facts, *frame);
    } else {
      ++facts.unusable;
    }
  }
}

}  // namespace perception
