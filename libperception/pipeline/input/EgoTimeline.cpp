#include "libperception/pipeline/input/EgoTimeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "libperception/sensors/observations/Conversions.h"

namespace perception {
namespace {

/// [m/s] growth of the position's standard deviation without poses; assumed.
constexpr double kGapDrift = 1.0;
constexpr double kLongestStart = 1.0;  ///< [s] that odometry is waited for; assumed

}  // namespace

void EgoTimeline::add(const mrpt::obs::CObservation& observation) {
  const auto accepted = pose_.accepted(), jumps = pose_.rejectedJumps(),
             invalid = pose_.rejectedInvalid(), relocations = pose_.relocations();
  pose_.add(observation);
  const auto report = [&](const std::string& what) {
    events_.warn(toStamp(observation.timestamp), event_kind::kEgoJump,
                 observation.sensorLabel + ": " + what);
  };
  if (pose_.relocations() > relocations) {
    report("the rejected poses agree with each other: the vehicle is there, tracks start anew");
  } else if (pose_.rejectedJumps() > jumps && !std::exchange(in_jump_, true)) {
    report(fmt::format("a pose away from the one before by more than {:g} m/s: rejected",
                       params_.max_speed));
  } else if (pose_.rejectedInvalid() > invalid && !std::exchange(in_invalid_, true)) {
    report("a pose without stamp or place on Earth: rejected");
  }
  if (pose_.accepted() > accepted || pose_.relocations() > relocations)
    in_jump_ = in_invalid_ = false;
}

void EgoTimeline::addScan(const SensorFrame& frame) {
  if (params_.source != EgoPoseParams::Source::kLidar) return;
  const auto lost = odometry_.lost();
  const auto pose = odometry_.update(frame);
  if (!pose) return;
  EgoState state = EgoPose::parked(frame.stamp, params_.minimum);
  state.T_world_ego = *pose;
  pose_.add(state);
  const bool is_lost = odometry_.lost() > lost;
  if (is_lost && !in_lost_)
    events_.warn(frame.stamp, event_kind::kEgoGap,
                 frame.sensor + ": a scan that fits none before: the vehicle is taken to go on");
  in_lost_ = is_lost;
}

void EgoTimeline::addRadars(const std::vector<const SensorFrame*>& frames) {
  if (params_.source != EgoPoseParams::Source::kRadar || frames.empty()) return;
  const auto lost = radar_odometry_.lost();
  auto state = radar_odometry_.update(frames);
  if (!state) return;
  const PoseUncertainty least = params_.minimum;
  state->uncertainty.sigma_xy = std::max(least.sigma_xy, state->uncertainty.sigma_xy);
  state->uncertainty.sigma_yaw = std::max(least.sigma_yaw, state->uncertainty.sigma_yaw);
  pose_.add(*state);
  const bool is_lost = radar_odometry_.lost() > lost;
  if (is_lost && !in_lost_)
    events_.warn(state->stamp, event_kind::kEgoGap,
                 "radar targets that fit no motion of the vehicle: it is taken to go on");
  in_lost_ = is_lost;
}

bool EgoTimeline::changedFrame(Stamp stamp) {
  const bool changed = std::exchange(frame_epoch_, pose_.frameEpoch()) != pose_.frameEpoch();
  if (!changed || !last_seen_) return false;
  events_.add(stamp, event_kind::kEgoGap, "another world frame from here: tracks start anew");
  return true;
}

bool EgoTimeline::isBlindGap(Stamp stamp) {
  if (!pose_.empty() || !last_seen_) return false;
  const double gap = stamp - *last_seen_;
  if (gap <= params_.blind_gap) return false;
  events_.warn(stamp, event_kind::kEgoGap,
               fmt::format("nothing seen for {:.3f} s, and nothing tells how the vehicle moved: "
                           "tracks start anew",
                           gap));
  return true;
}

bool EgoTimeline::isStarting(Stamp stamp) {
  if (!params_.isOdometry()) return false;
  if (!start_) start_ = stamp;
  const bool is_known = !pose_.empty() && pose_.earliest() < pose_.latest();
  return !is_known && stamp - *start_ < kLongestStart;
}

EgoState EgoTimeline::at(Stamp stamp) {
  if (pose_.empty()) {
    if (!none_reported_)
      events_.warn(stamp, event_kind::kEgoGap,
                   "no ego pose yet: the vehicle is taken to stand still");
    none_reported_ = true;
    return EgoPose::parked(stamp, params_.minimum);
  }
  if (const auto state = pose_.at(stamp)) {
    in_gap_ = false;
    return *state;
  }
  const Stamp nearest = stamp < pose_.earliest() ? pose_.earliest() : pose_.latest();
  EgoState state = pose_.at(nearest).value_or(EgoPose::parked(stamp, params_.minimum));
  const double gap = stamp - state.stamp;
  if (!in_gap_) {
    events_.warn(stamp, event_kind::kEgoGap,
                 fmt::format("no ego pose for {:.3f} s: extrapolated", std::abs(gap)));
  }
  in_gap_ = true;
  state.T_world_ego.translation().head<2>() += gap * state.velocity;
  state.uncertainty.sigma_xy += kGapDrift * std::abs(gap);
  state.stamp = stamp;
  return state;
}

void EgoTimeline::clear() {
  pose_.clear();
  odometry_.clear();
  radar_odometry_.clear();
  last_seen_.reset();
  start_.reset();
  none_reported_ = false;
  in_gap_ = in_jump_ = in_invalid_ = in_lost_ = false;
}

}  // namespace perception
