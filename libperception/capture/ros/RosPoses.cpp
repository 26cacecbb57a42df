#include "libperception/capture/ros/RosPoses.h"

#include <fmt/format.h>

#include <cstddef>
#include <stdexcept>
#include <utility>

#include "libperception/interop/ros/PoseSeries.h"
#include "libperception/sensors/frames/ToObservation.h"

namespace perception {
namespace {

// Bounds of what is held, whatever comes.
constexpr std::size_t kMostChildren = 1000, kMostMoves = 2000, kMostPoses = 2000;
constexpr double kTreeLength = 10, kTreeAhead = 1;  // [s] of transforms about the newest
constexpr double kPoseWait = 0.1;  // [s] of a pose for the other steps between world and vehicle

template <class Queue>
void trimTo(Queue& queue, std::size_t most) {
  if (queue.size() > most)
    queue.erase(queue.begin(), queue.begin() + static_cast<std::ptrdiff_t>(queue.size() - most));
}

}  // namespace

RosPoses::RosPoses(BagContents& contents, const std::string& source, Give give)
    : contents_(contents), give_(std::move(give)) {
  if (!source.empty()) from_ = source;
}

void RosPoses::setBase(const std::string& frame, const Pose3& T_ego_base) {
  base_ = frame;
  T_ego_base_ = T_ego_base;
}

void RosPoses::plant(Stamp received) {
  const auto noted = std::exchange(contents_.transforms, {});
  for (const auto& [child, transforms] : noted) {
    if (frames_.size() >= kMostChildren && frames_.count(child) == 0)
      throw std::runtime_error(
          fmt::format("a transform of \"{}\" beside those of {} frames", child, kMostChildren));
    frames_.insert(child);
    for (std::size_t i = 0; i < transforms.poses.size(); ++i) {
      const PoseSeries::Row t = transforms.poses.row(i);
      contents_.tree.add(transforms.parent, child, t.stamp, t.pose, transforms.fixed);
      if (transforms.fixed) continue;
      contents_.tree.keep(child, t.stamp + -kTreeLength, t.stamp + kTreeAhead);
      moves_.push_back({child, t.stamp, received});
    }
  }
  trimTo(moves_, kMostMoves);
  for (auto& row : contents_.poses) {
    PoseSeries& poses = row.second.poses;
    if (poses.size() > kMostPoses) poses.keep(poses.size() - kMostPoses, poses.size());
    row.second.messages.clear();
  }
}

void RosPoses::choose(bool waited) {
  if (from_) return;
  if (!contents_.tree.movesIn(base_).empty()) {
    from_ = "tf";
  } else if (waited) {
    from_ = "none";
    for (const auto& [topic, poses] : contents_.poses) {
      if (*from_ == "none" && !poses.on_call) from_ = topic;
    }
  }
}

void RosPoses::give(Stamp now, bool waited, Stamp until) {
  choose(waited);
  if (!from_) return;
  if (*from_ == "tf")
    giveOfTree(now, until);
  else
    moves_.clear();
  giveOfTopics(until);
}

void RosPoses::giveOfTree(Stamp now, Stamp until) {
  const std::string mover = contents_.tree.moverOf(base_);
  const std::string world = contents_.tree.movesIn(base_);
  if (mover.empty() || world.empty()) return;
  const Stamp known = contents_.tree.knownUntil(base_);
  for (; !moves_.empty(); moves_.pop_front()) {
    const Move& move = moves_.front();
    if (move.child != mover) continue;
    if (until < move.stamp) return;
    if (known < move.stamp && now - move.received < kPoseWait) return;
    if (const auto T = contents_.tree.at(world, base_, move.stamp)) givePose(move.stamp, *T);
  }
}

void RosPoses::giveOfTopics(Stamp until) {
  for (auto& [topic, given] : contents_.poses) {
    std::size_t done = 0;
    for (; topic == *from_ && done < given.poses.size(); ++done) {
      const PoseSeries::Row pose = given.poses.row(done);
      if (until < pose.stamp) break;
      const bool of_base = given.frame.empty() || given.frame == base_;
      const auto T_pose_base = of_base ? std::optional<Pose3>(Pose3::Identity())
                                       : contents_.tree.at(given.frame, base_, pose.stamp);
      givePose(pose.stamp, pose.pose * T_pose_base.value_or(Pose3::Identity()));
    }
    given.poses.keep(topic == *from_ ? done : given.poses.size(), given.poses.size());
  }
}

void RosPoses::givePose(Stamp stamp, const Pose3& T_world_base) {
  if (last_ && *last_ == stamp) return;
  last_ = stamp;
  EgoState ego;
  ego.stamp = stamp;
  ego.T_world_ego = T_world_base * T_ego_base_.inverse();
  ego.uncertainty = {0, 0, 0};
  give_(poseObservation(ego));
  ++given_;
}

std::string RosPoses::note() const {
  if (!from_ || *from_ == "none")
    return "no poses are taken: they are found from GPS and inertial unit, or by odometry";
  return fmt::format("poses: {} of frame \"{}\" from {}", given_, base_,
                     *from_ == "tf" ? "tf, in \"" + contents_.tree.movesIn(base_) + "\"" : *from_);
}

std::string RosPoses::fault() const {
  if (!from_ || *from_ == "none" || given_ > 0) return "";
  return fmt::format("no pose came from {}", *from_);
}

}  // namespace perception
