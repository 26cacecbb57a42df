#include "libperception/importers/bags/BagQueue.h"

#include <fmt/format.h>

#include "libperception/interop/ros/PoseSeries.h"

namespace perception {
namespace {

/// [s] Messages are sorted by their stamps over this time of recording.
constexpr double kSorted = 1;
/// [s] Poses are written from this long before the first to this long after the last sensor data.
constexpr double kBagPoseMargin = 0.5;

}  // namespace

/// Poses up to the stamp, but those long before the first data.
void BagQueue::writePoses(Stamp until) {
  for (; next_pose_ < choices_.poses.size(); ++next_pose_) {
    const PoseSeries::Row pose = choices_.poses.row(next_pose_);
    if (pose.stamp > until) break;
    if (!last_ && until - pose.stamp >= kBagPoseMargin) continue;
    log_.ego(pose.stamp, pose.pose);
    ++written_poses_;
  }
}

/// Writes what is older than `until`; all without one.
void BagQueue::flush(std::optional<Stamp> until) {
  while (!queue_.empty() && (!until || queue_.begin()->first < *until)) {
    const auto first = queue_.extract(queue_.begin());
    writePoses(first.key());
    last_ = first.key();
    first.mapped()();
  }
}

void BagQueue::passed(Stamp recorded) { flush(recorded + -kSorted); }

void BagQueue::finish() {
  flush({});
  if (last_) writePoses(*last_ + kBagPoseMargin);
}

void BagQueue::tellPoses() const {
  if (choices_.poses_from.empty()) return;
  const PoseSeries& poses = choices_.poses;
  const std::string of = fmt::format("of frame \"{}\" from {}", choices_.base, choices_.poses_from);
  if (poses.empty() || written_poses_ > 0) {
    log_.note(fmt::format("poses: {} {}", written_poses_, of));
    return;
  }
  log_.warn(
      fmt::format("poses: none of the {} {} lies within the time of the sensors: theirs are "
                  "{:.3f} to {:.3f} s, the last sensor's is {:.3f} s; do the clocks differ?",
                  poses.size(), of, poses.row(0).stamp.seconds(),
                  poses.row(poses.size() - 1).stamp.seconds(), last_ ? last_->seconds() : 0));
}

}  // namespace perception
