#include "libperception/evaluation/matching/TruthAlignment.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace perception {
namespace {

using TruthInstant = GroundTruth::Instant;

constexpr double kSameTruthInstant =
    1e-6;  // [s] stamps are rounded to 0.2 us when they are read as seconds

const TruthObject* find(const TruthInstant& instant, std::int64_t id) {
  if (id < 0) return nullptr;
  for (const TruthObject& object : instant.objects) {
    if (object.id == id) return &object;
  }
  return nullptr;
}

TruthObject moved(TruthObject object, double t) {
  if (std::isfinite(object.vx) && std::isfinite(object.vy)) {
    object.position.head<2>() += (t - object.t) * Vector2(object.vx, object.vy);
  }
  object.t = t;
  return object;
}

// The object between two of its truths; `share` in [0, 1] of the way from a to b. Discrete values
// (type, occlusion, points) and values missing in one of them are those of the nearer one.
TruthObject between(const TruthObject& a, const TruthObject& b, double share) {
  TruthObject object = share <= 0.5 ? a : b;
  const auto mix = [share](double from, double to) { return from + share * (to - from); };
  object.position = a.position + share * (b.position - a.position);
  if (std::isfinite(a.yaw) && std::isfinite(b.yaw)) {
    object.yaw = wrapAngle(a.yaw + share * wrapAngle(b.yaw - a.yaw));
  }
  if (std::isfinite(a.vx + a.vy) && std::isfinite(b.vx + b.vy)) {
    object.vx = mix(a.vx, b.vx);
    object.vy = mix(a.vy, b.vy);
  }
  object.t = mix(a.t, b.t);
  return object;
}

std::vector<TruthObject> interpolated(const TruthInstant& before, const TruthInstant& after,
                                      double t) {
  const double share = (t - before.t) / (after.t - before.t);
  const TruthInstant& nearer = share <= 0.5 ? before : after;
  const TruthInstant& other = share <= 0.5 ? after : before;
  std::vector<TruthObject> objects;
  for (const TruthObject& object : nearer.objects) {
    const TruthObject* there = find(other, object.id);
    if (!there) {
      objects.push_back(moved(object, t));
    } else {
      objects.push_back(share <= 0.5 ? between(object, *there, share)
                                     : between(*there, object, share));
    }
  }
  return objects;
}

// The truth at a time of the log; records which instants were used.
class TruthByTime {
 public:
  TruthByTime(const GroundTruth& truth, double limit, std::vector<bool>& used)
      : instants_(truth.instants), limit_(limit), used_(used) {}

  bool at(double t, std::vector<TruthObject>& objects) const {
    const auto after =
        std::lower_bound(instants_.begin(), instants_.end(), t,
                         [](const TruthInstant& i, double time) { return i.t < time; });
    const bool has_after = after != instants_.end(), has_before = after != instants_.begin();
    const double to_after = has_after ? after->t - t : limit_ + 1;
    const double to_before = has_before ? t - std::prev(after)->t : limit_ + 1;
    if (std::min(to_after, to_before) > limit_) return false;
    const auto nearest = to_before < to_after ? std::prev(after) : after;
    used_[static_cast<std::size_t>(nearest - instants_.begin())] = true;
    if (std::min(to_after, to_before) <= kSameTruthInstant) {
      objects = nearest->objects;
    } else if (has_after && has_before && to_after + to_before <= 2 * limit_) {
      used_[static_cast<std::size_t>(after - instants_.begin())] = true;
      used_[static_cast<std::size_t>(after - instants_.begin()) - 1] = true;
      objects = interpolated(*std::prev(after), *after, t);
    } else {
      for (const TruthObject& object : nearest->objects) objects.push_back(moved(object, t));
    }
    return true;
  }

 private:
  const std::vector<TruthInstant>& instants_;
  double limit_;
  std::vector<bool>& used_;
};

/// The vehicle's pose in the truth's world at the stamp of a scene.
std::optional<Pose3> truthPose(const TrackedRun& poses, Stamp stamp) {
  auto ego = egoAt(poses, stamp);
  for (const double off : {-kSameTruthInstant, kSameTruthInstant})  // at the ends
    if (!ego) ego = egoAt(poses, stamp + off);
  return ego ? std::optional(ego->T_world_ego) : std::nullopt;
}

void transform(const Pose3& T, std::vector<TruthObject>& objects) {
  for (TruthObject& object : objects) {
    object.position = T * object.position;
    const Vector3 ahead = T.linear() * Vector3(std::cos(object.yaw), std::sin(object.yaw), 0);
    object.yaw = std::atan2(ahead.y(), ahead.x());
    const Vector3 v = T.linear() * Vector3(object.vx, object.vy, 0);
    object.vx = v.x();
    object.vy = v.y();
  }
}

}  // namespace

TruthAlignment alignTruth(const TrackedRun& run, const GroundTruth& truth,
                          const AlignmentOptions& options) {
  std::map<std::int64_t, std::size_t> by_frame;
  for (std::size_t i = 0; i < truth.instants.size(); ++i) {
    if (truth.instants[i].frame >= 0) by_frame.emplace(truth.instants[i].frame, i);
  }
  std::vector<bool> used(truth.instants.size(), false);
  const TruthByTime by_time(truth, options.time_limit, used);

  TruthAlignment alignment;
  for (std::size_t s = 0; s < run.scenes.size(); ++s) {
    const Scene& scene = run.scenes[s];
    TruthAtScene instant{s, {}};
    bool known = false;
    if (scene.frame >= 0 && !by_frame.empty()) {
      const auto found = by_frame.find(scene.frame);
      known = found != by_frame.end();
      if (known) {
        instant.objects = truth.instants[found->second].objects;
        used[found->second] = true;
        ++alignment.by_frame;
      }
    } else if (by_time.at(scene.stamp - run.first_stamp, instant.objects)) {
      known = true;
      ++alignment.by_time;
    }
    if (!known && options.empty_frames) {
      known = true;
      ++alignment.assumed_empty;
    }
    if (known && options.truth_poses) {
      const auto pose = truthPose(*options.truth_poses, scene.stamp);
      known = pose.has_value();
      if (pose) transform(scene.ego.T_world_ego * pose->inverse(), instant.objects);
    }
    if (known) {
      alignment.instants.push_back(std::move(instant));
    } else {
      ++alignment.scenes_without_truth;
    }
  }
  alignment.truth_without_scene =
      static_cast<std::size_t>(std::count(used.begin(), used.end(), false));
  return alignment;
}

}  // namespace perception
