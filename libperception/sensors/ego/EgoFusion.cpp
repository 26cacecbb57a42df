#include "libperception/sensors/ego/EgoFusion.h"

#include <mrpt/obs/CObservationGPS.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "libperception/sensors/observations/Conversions.h"

namespace perception {

namespace {

constexpr double kHistory = 10;            // [s] of poses
constexpr std::size_t kMostSteps = 20000;  // bound of the memory at any rate

}  // namespace

EgoFusion::EgoFusion(FusionParams params) : motion_(std::move(params)), steps_(1) {}

void EgoFusion::clear() {
  odometers_ = {};
  steps_.assign(1, {});
  poses_.clear();
  T_world_start_ = Pose3::Identity();
}

std::optional<EgoReading> EgoFusion::readingOf(const mrpt::obs::CObservation& observation) {
  using namespace mrpt::obs;
  const auto* imu = dynamic_cast<const CObservationIMU*>(&observation);
  const auto* wheels = dynamic_cast<const CObservationOdometry*>(&observation);
  const auto* gnss = dynamic_cast<const CObservationGPS*>(&observation);
  if (imu == nullptr && wheels == nullptr && gnss == nullptr) return {};
  const FusionParams& p = motion_.params();
  const std::string& label = imu != nullptr      ? p.imu_label
                             : wheels != nullptr ? p.wheels_label
                                                 : p.gnss_label;
  if (!label.empty() && label != observation.sensorLabel) return {};
  std::optional<EgoReading> reading;
  if (const auto stamp = toStamp(observation.timestamp)) {
    if (imu != nullptr) {
      if (const auto r = imuReading(*imu)) reading = *r;
    } else if (wheels != nullptr) {
      if (const auto r = odometers_.read(*wheels, *stamp)) reading = *r;
    } else if (const auto r = gnssFix(*gnss, p.gnss)) {
      reading = *r;
    }
  }
  if (!reading) ++unusable_;
  return reading;
}

// A strict order of readings of one instant, so that the order of arrival does not matter.
bool EgoFusion::before(const Step& a, const Step& b) {
  return std::make_tuple(a.stamp.ns, a.reading.index(), a.label) <
         std::make_tuple(b.stamp.ns, b.reading.index(), b.label);
}

bool EgoFusion::add(const mrpt::obs::CObservation& observation) {
  auto reading = readingOf(observation);
  if (!reading) return false;
  Step step{*toStamp(observation.timestamp), observation.sensorLabel, std::move(*reading), {}};
  const bool running = state().started;
  const double behind = running ? steps_.back().stamp - step.stamp : 0;
  // The base summarizes all earlier readings: nothing can be inserted before it.
  const bool before_base = steps_.front().state.started && !before(steps_.front(), step);
  if (behind > motion_.params().late || before_base) {
    ++late_;
    return false;
  }
  const auto place = steps_.insert(std::upper_bound(steps_.begin() + 1, steps_.end(), step, before),
                                   std::move(step));
  while (!poses_.empty() && poses_.back().stamp >= place->stamp) poses_.pop_back();
  for (auto at = place; at != steps_.end(); ++at) {
    at->state = motion_.after(std::prev(at)->state, at->stamp, at->reading);
    publish(at->state);
  }
  while (steps_.size() > kMostSteps ||
         (steps_.size() > 2 && steps_.back().stamp - steps_[1].stamp > motion_.params().late))
    steps_.pop_front();
  while (poses_.size() > kMostSteps ||
         (!poses_.empty() && poses_.back().stamp - poses_.front().stamp > kHistory))
    poses_.pop_front();
  return true;
}

void EgoFusion::publish(const EgoMotionState& state) {
  // Transforms poses from before the heading was known into the world frame, again when a late
  // reading changes the transform.
  const Pose3& wanted = state.T_world_start;
  if (!wanted.isApprox(T_world_start_, 0)) {
    const Pose3 change = wanted * T_world_start_.inverse();
    const Eigen::Matrix2d turn = change.linear().topLeftCorner<2, 2>();
    for (EgoState& pose : poses_) {
      pose.T_world_ego = change * pose.T_world_ego;
      pose.velocity = turn * pose.velocity;
    }
    T_world_start_ = wanted;
  }
  const EgoVector& x = state.estimate.x;
  const EgoMatrix& P = state.estimate.P;
  EgoState pose;
  pose.stamp = state.stamp;
  pose.T_world_ego = state.estimate.pose();
  pose.velocity =
      x[kEgoSpeed] * std::cos(x[kEgoPitch]) * Vector2(std::cos(x[kEgoYaw]), std::sin(x[kEgoYaw]));
  pose.yaw_rate = motion_.yawRate(state);
  pose.uncertainty.sigma_xy = std::sqrt((P(kEgoX, kEgoX) + P(kEgoY, kEgoY)) / 2);
  pose.uncertainty.sigma_yaw = std::sqrt(P(kEgoYaw, kEgoYaw));
  pose.uncertainty.sigma_pitch = std::sqrt(P(kEgoPitch, kEgoPitch));
  if (!poses_.empty() && poses_.back().stamp == pose.stamp) poses_.pop_back();
  poses_.push_back(pose);
}

}  // namespace perception
