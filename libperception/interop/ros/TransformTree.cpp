#include "libperception/interop/ros/TransformTree.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>

#include "libperception/core/PoseSteps.h"

namespace perception {
namespace {

constexpr double kReach = 0.2;  // [s] beyond the first and last pose

}  // namespace

void TransformTree::add(const std::string& parent, const std::string& child, Stamp stamp,
                        const Pose3& T, bool fixed) {
  if (parent == child) return;
  Step& step = steps_[child];
  if (step.parent != parent || step.fixed != fixed) {
    step.poses = {};
    step.parent = parent;
    step.fixed = fixed;
  }
  if (fixed) step.poses = {};
  step.poses.add(stamp, T);
}

void TransformTree::settle() {
  for (auto& row : steps_) row.second.poses.sort(true);
}

std::optional<Pose3> TransformTree::inParent(const Step& step, Stamp stamp) const {
  const PoseSeries& poses = step.poses;
  if (step.fixed) return poses.row(0).pose;
  const std::size_t at = poses.firstFrom(stamp);
  if (at == 0 || at == poses.size()) {
    const PoseSeries::Row end = poses.row(at == 0 ? 0 : at - 1);
    if (std::abs(end.stamp - stamp) > kReach) return {};
    return end.pose;
  }
  const PoseSeries::Row after = poses.row(at);
  if (after.stamp == stamp) return after.pose;
  const PoseSeries::Row before = poses.row(at - 1);
  return interpolate(before.pose, after.pose,
                     (stamp - before.stamp) / (after.stamp - before.stamp));
}

std::vector<std::string> TransformTree::ancestors(const std::string& frame) const {
  std::vector<std::string> chain{frame};
  std::set<std::string> seen{frame};
  for (auto step = steps_.find(frame); step != steps_.end(); step = steps_.find(chain.back())) {
    if (!seen.insert(step->second.parent).second) break;
    chain.push_back(step->second.parent);
  }
  return chain;
}

std::optional<Pose3> TransformTree::at(const std::string& to, const std::string& from,
                                       Stamp stamp) const {
  const auto up = ancestors(from), other = ancestors(to);
  const auto common = std::find_if(up.begin(), up.end(), [&](const std::string& frame) {
    return std::find(other.begin(), other.end(), frame) != other.end();
  });
  if (common == up.end()) return {};
  const auto below = [&](const std::vector<std::string>& chain) -> std::optional<Pose3> {
    Pose3 T = Pose3::Identity();
    for (const std::string& frame : chain) {
      if (frame == *common) break;
      const auto step = inParent(steps_.at(frame), stamp);
      if (!step) return {};
      T = *step * T;
    }
    return T;
  };
  const auto T_common_from = below(up), T_common_to = below(other);
  if (!T_common_from || !T_common_to) return {};
  return T_common_to->inverse() * *T_common_from;
}

bool TransformTree::has(const std::string& frame) const {
  return std::any_of(steps_.begin(), steps_.end(), [&](const auto& step) {
    return step.first == frame || step.second.parent == frame;
  });
}

std::string TransformTree::movesIn(const std::string& frame) const {
  return movingStep(frame) == nullptr ? "" : ancestors(frame).back();
}

const PoseSeries* TransformTree::movingStep(const std::string& frame) const {
  const auto step = steps_.find(moverOf(frame));
  return step == steps_.end() ? nullptr : &step->second.poses;
}

std::string TransformTree::moverOf(const std::string& frame) const {
  for (const std::string& above : ancestors(frame)) {
    const auto step = steps_.find(above);
    if (step != steps_.end() && !step->second.fixed) return above;
  }
  return "";
}

bool TransformTree::travelsIn(const std::string& above, const std::string& frame) const {
  const auto chain = ancestors(frame);
  const auto mover = std::find(chain.begin(), chain.end(), moverOf(frame));
  return mover != chain.end() && std::find(mover + 1, chain.end(), above) != chain.end();
}

Stamp TransformTree::knownUntil(const std::string& frame) const {
  Stamp until{std::numeric_limits<std::int64_t>::max()};
  for (const std::string& above : ancestors(frame)) {
    const auto step = steps_.find(above);
    if (step == steps_.end() || step->second.fixed) continue;
    const PoseSeries& poses = step->second.poses;
    until = std::min(until, poses.row(poses.size() - 1).stamp);
  }
  return until;
}

void TransformTree::keep(const std::string& child, Stamp from, Stamp until) {
  const auto step = steps_.find(child);
  if (step == steps_.end() || step->second.fixed) return;
  PoseSeries& poses = step->second.poses;
  poses.sort(true);
  const std::size_t end = std::max<std::size_t>(poses.firstFrom(Stamp{until.ns + 1}), 1);
  const std::size_t begin = std::min(poses.firstFrom(from), end - 1);
  // A series is copied: not for each of its rows.
  if (end < poses.size() || 2 * begin > poses.size()) poses.keep(begin, end);
}

std::vector<std::string> TransformTree::moving() const {
  std::vector<std::string> frames;
  for (const auto& [child, step] : steps_) {
    if (!step.fixed && steps_.count(step.parent) == 0) frames.push_back(child);
  }
  return frames;
}

}  // namespace perception
