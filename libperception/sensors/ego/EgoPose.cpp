#include "libperception/sensors/ego/EgoPose.h"

#include <mrpt/obs/CObservationRobotPose.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "libperception/core/PoseSteps.h"
#include "libperception/sensors/ego/EgoFusion.h"
#include "libperception/sensors/ego/PoseMotion.h"
#include "libperception/sensors/frames/ToObservation.h"  // kEgoPoseLabel
#include "libperception/sensors/observations/Conversions.h"

namespace perception {

namespace {

/// Number of consecutive poses, consistent with each other but not with the former position, after
/// which they are accepted: a receiver with a new fix. One second at 10 Hz.
constexpr std::size_t kRelocation = 10;
/// Bound of the memory at any rate of the poses.
constexpr std::size_t kMostPoses = 20000;
/// [m] Largest coordinate, that of a pole in UTM with a margin: what is beyond is no place on
/// Earth.
constexpr double kFarthest = 2e7;

bool before(const EgoState& pose, Stamp stamp) { return pose.stamp < stamp; }

/// Standard deviation by a variance of the log, at least `minimum`.
double sigmaOf(double variance, double minimum) {
  return std::isfinite(variance) && variance > 0 ? std::max(minimum, std::sqrt(variance)) : minimum;
}

void setMotion(EgoState& state, const std::deque<EgoState>& poses) {
  const PoseMotion motion = motionAt(poses, state.stamp);
  state.velocity = motion.velocity, state.yaw_rate = motion.yaw_rate;
}

EgoState between(const EgoState& a, const EgoState& b, Stamp stamp) {
  const double s = (stamp - a.stamp) / (b.stamp - a.stamp);
  EgoState state = s < 0.5 ? a : b;
  state.stamp = stamp;
  state.T_world_ego = interpolate(a.T_world_ego, b.T_world_ego, s);
  state.velocity = (1 - s) * a.velocity + s * b.velocity;
  state.yaw_rate = (1 - s) * a.yaw_rate + s * b.yaw_rate;
  return state;
}

}  // namespace

void EgoPoseParams::visit(ParamVisitor& v) {
  v.choiceOf(
      "source", source, {"auto", "poses", "fusion", "lidar", "radar"},
      "the log's poses; fusion of satellites, inertial unit and wheels; odometry from the "
      "first lidar in use, or from the range rates of all radars in use; auto: poses where there "
      "are some, else fusion");
  v.text("label", label,
         "label of the pose observations; empty: EGO_POSE, or the first pose label of the log");
  v.real("sigma_xy", minimum.sigma_xy, {0, 10}, "m",
         "least standard deviation of the position (method.md 1.3)");
  v.angle("sigma_yaw_deg", minimum.sigma_yaw, {0, 45},
          "least standard deviation of the heading (method.md 1.3)");
  v.angle("sigma_pitch_deg", minimum.sigma_pitch, {0, 45},
          "least standard deviation of the pitch (method.md 1.3)");
  v.real("max_speed", max_speed, {1, 1000}, "m/s",
         "a pose that implies more is rejected as a jump");
  fusion.visit(v);
  v.expert();
  v.real("blind_gap", blind_gap, {0.1, 1e6}, "s",
         "without scans, in a log without ego motion, after which tracks start anew");
}

EgoPose::EgoPose(EgoPoseParams params)
    : params_(std::move(params)),
      fusion_(std::make_unique<EgoFusion>(params_.fusion)),
      label_(params_.label) {}

EgoPose::~EgoPose() = default;

const std::deque<EgoState>& EgoPose::poses() const {
  return poses_.empty() ? fusion_->poses() : poses_;
}

std::uint64_t EgoPose::frameEpoch() const { return frame_epoch_ + fusion_->state().relocations; }

EgoState EgoPose::parked(Stamp stamp, const PoseUncertainty& uncertainty) {
  EgoState state;
  state.stamp = stamp;
  state.uncertainty = uncertainty;
  return state;
}

void EgoPose::clear() {
  frame_epoch_ += fusion_->state().relocations;
  fusion_->clear();
  poses_.clear();
  relocated_.clear();
}

bool EgoPose::wants(const std::string& label) {
  if (!params_.label.empty()) return label == params_.label;
  if (label == kEgoPoseLabel &&
      label_ != kEgoPoseLabel) {  // EGO_POSE came late: drop the substitute label and its world
    if (!empty()) ++frame_epoch_;
    clear();
    label_ = label;
  }
  if (label_.empty()) label_ = label.empty() ? "(none)" : label;
  return label == label_ || (label.empty() && label_ == "(none)");
}

std::optional<EgoState> loggedPose(const mrpt::obs::CObservation& observation) {
  const auto* pose = dynamic_cast<const mrpt::obs::CObservationRobotPose*>(&observation);
  const auto stamp = toStamp(observation.timestamp);
  if (pose == nullptr || !stamp) return std::nullopt;
  EgoState state;
  state.stamp = *stamp;
  state.T_world_ego = toPose3(pose->pose.mean);
  return state;
}

void EgoPose::add(const mrpt::obs::CObservation& observation) {
  if (params_.isOdometry()) return;
  const auto* pose = dynamic_cast<const mrpt::obs::CObservationRobotPose*>(&observation);
  if (pose == nullptr) {
    if (poses_.empty() && params_.source != EgoPoseParams::Source::kPoses)
      fusion_->add(observation);
    return;
  }
  if (params_.source == EgoPoseParams::Source::kFusion || !wants(pose->sensorLabel)) return;
  const auto logged = loggedPose(*pose);
  if (!logged) {
    ++rejected_invalid_;
    return;
  }
  EgoState state = *logged;
  const auto& cov = pose->pose.cov;  // order of MRPT: x y z yaw pitch roll
  state.uncertainty.sigma_xy = sigmaOf((cov(0, 0) + cov(1, 1)) / 2, params_.minimum.sigma_xy);
  state.uncertainty.sigma_yaw = sigmaOf(cov(3, 3), params_.minimum.sigma_yaw);
  state.uncertainty.sigma_pitch = sigmaOf(cov(4, 4), params_.minimum.sigma_pitch);
  add(state);
}

bool EgoPose::isJump(const EgoState& pose) {
  const auto after = std::lower_bound(poses_.begin(), poses_.end(), pose.stamp, before);
  const EgoState& neighbor = after == poses_.begin() ? *after : *std::prev(after);
  const auto tooFast = [this](const EgoState& a, const EgoState& b) {
    const double distance = (a.T_world_ego.translation() - b.T_world_ego.translation()).norm();
    // At least 10 ms: poses of nearly the same instant differ by noise.
    return distance > params_.max_speed * std::max(std::abs(a.stamp - b.stamp), 0.01);
  };
  if (!tooFast(neighbor, pose)) {
    relocated_.clear();
    return false;
  }
  if (!relocated_.empty() &&
      (pose.stamp <= relocated_.back().stamp || tooFast(relocated_.back(), pose))) {
    relocated_.clear();
  }
  relocated_.push_back(pose);
  return true;
}

void EgoPose::add(const EgoState& pose) {
  const auto& T = pose.T_world_ego;
  if (!T.matrix().allFinite() || T.translation().cwiseAbs().maxCoeff() > kFarthest) {
    ++rejected_invalid_;
    return;
  }
  if (poses_.empty() && !fusion_->poses().empty())
    ++frame_epoch_;  // the poses of the log replace the fusion
  if (!poses_.empty()) {
    const auto place = std::lower_bound(poses_.begin(), poses_.end(), pose.stamp, before);
    const bool same_instant = place != poses_.end() && place->stamp == pose.stamp;
    if (same_instant || latest() - pose.stamp > params_.history) {
      ++rejected_other_;
      return;
    }
    if (isJump(pose)) {
      ++rejected_jumps_;
      if (relocated_.size() < kRelocation) return;
      poses_.swap(relocated_);
      relocated_.clear();
      ++relocations_;
      ++frame_epoch_;
      return;
    }
  }
  poses_.insert(std::lower_bound(poses_.begin(), poses_.end(), pose.stamp, before), pose);
  ++accepted_;
  while (poses_.size() > kMostPoses || latest() - poses_.front().stamp > params_.history)
    poses_.pop_front();
}

std::optional<EgoState> EgoPose::at(Stamp stamp) const {
  if (empty()) return {};
  const auto& all = poses();
  EgoState state;
  const auto after = std::lower_bound(all.begin(), all.end(), stamp, before);
  if (after != all.end() && (after->stamp == stamp || after != all.begin())) {
    state = after->stamp == stamp ? *after : between(*std::prev(after), *after, stamp);
    if (!fused()) setMotion(state, poses_);
  } else {
    state = after == all.end() ? all.back() : all.front();
    const double dt = stamp - state.stamp;
    if (std::abs(dt) > params_.extrapolation) return {};
    if (!fused()) setMotion(state, poses_);
    state.stamp = stamp;
    state.T_world_ego.translation().head<2>() += dt * state.velocity;
    state.T_world_ego.linear() =
        Eigen::AngleAxisd(dt * state.yaw_rate, Vector3::UnitZ()).toRotationMatrix() *
        state.T_world_ego.linear();
  }
  if (fused()) {
    auto& u = state.uncertainty;
    u.sigma_xy = std::max(u.sigma_xy, params_.minimum.sigma_xy);
    u.sigma_yaw = std::max(u.sigma_yaw, params_.minimum.sigma_yaw);
    u.sigma_pitch = std::max(u.sigma_pitch, params_.minimum.sigma_pitch);
  }
  return state;
}

}  // namespace perception
