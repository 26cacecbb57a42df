#include "libperception/interop/TransformTree.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <set>

namespace perception {
namespace {

constexpr double kReach = 0.2;  // [s] beyond the first and last pose

Pose3 between(const Pose3& a, const Pose3& b, double share) {
  Pose3 pose = Pose3::Identity();
  pose.translation() = (1 - share) * a.translation() + share * b.translation();
  pose.linear() = Eigen::Quaterniond(a.linear())
                      .slerp(share, Eigen::Quaterniond(b.linear()))
                      .toRotationMatrix();
  return pose;
}

}  // namespace

void TransformTree::add(const std::string& parent, const std::string& child, Stamp stamp,
                        const Pose3& T, bool fixed) {
  if (parent == child) return;
  Step& step = steps_[child];
  if (step.parent != parent || step.fixed != fixed) {
    step.poses.clear();
    step.parent = parent;
    step.fixed = fixed;
  }
  if (fixed) step.poses.clear();
  step.poses[stamp] = T;
}

std::optional<Pose3> TransformTree::inParent(const Step& step, Stamp stamp) const {
  if (step.fixed) return step.poses.begin()->second;
  const auto after = step.poses.lower_bound(stamp);
  if (after != step.poses.end() && after->first == stamp) return after->second;
  if (after == step.poses.begin() || after == step.poses.end()) {
    const auto& end = after == step.poses.end() ? *step.poses.rbegin() : *after;
    if (std::abs(end.first - stamp) > kReach) return {};
    return end.second;
  }
  const auto before = std::prev(after);
  return between(before->second, after->second,
                 (stamp - before->first) / (after->first - before->first));
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
  const auto chain = ancestors(frame);
  return stampsOf(frame).empty() ? "" : chain.back();
}

std::string TransformTree::moverOf(const std::string& frame) const {
  for (const std::string& above : ancestors(frame)) {
    const auto step = steps_.find(above);
    if (step != steps_.end() && !step->second.fixed) return above;
  }
  return "";
}

std::vector<Stamp> TransformTree::stampsOf(const std::string& frame) const {
  std::vector<Stamp> stamps;
  const auto step = steps_.find(moverOf(frame));
  if (step == steps_.end()) return stamps;
  for (const auto& row : step->second.poses) stamps.push_back(row.first);
  return stamps;
}

Stamp TransformTree::knownUntil(const std::string& frame) const {
  Stamp until{std::numeric_limits<std::int64_t>::max()};
  for (const std::string& above : ancestors(frame)) {
    const auto step = steps_.find(above);
    if (step != steps_.end() && !step->second.fixed && !step->second.poses.empty())
      until = std::min(until, step->second.poses.rbegin()->first);
  }
  return until;
}

void TransformTree::keep(const std::string& child, Stamp from, Stamp until) {
  const auto step = steps_.find(child);
  if (step == steps_.end() || step->second.fixed) return;
  auto& poses = step->second.poses;
  while (poses.size() > 1 && until < poses.rbegin()->first) poses.erase(std::prev(poses.end()));
  while (poses.size() > 1 && poses.begin()->first < from) poses.erase(poses.begin());
}

std::vector<std::string> TransformTree::moving() const {
  std::vector<std::string> frames;
  for (const auto& [child, step] : steps_) {
    if (!step.fixed && steps_.count(step.parent) == 0) frames.push_back(child);
  }
  return frames;
}

}  // namespace perception
