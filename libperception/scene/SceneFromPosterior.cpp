#include "libperception/scene/SceneFromPosterior.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "libperception/core/system/Parallel.h"
#include "libperception/filter/predict/Prediction.h"
#include "libperception/filter/state/ClassFilterMotion.h"
#include "libperception/filter/update/HeadingUpdate.h"
#include "libperception/filter/update/Smoothing.h"

namespace perception {
namespace {

/// [m/s] an object without a heading takes the direction of its velocity from this speed on.
constexpr double kHeadingFromSpeed = 0.5;

/// Of the way that an object has traveled in images alone, this share counts as evidence of its
/// front. Ranges from images err alike from image to image, so a parked car drifts by meters along
/// the line of sight (counted on nine KITTI sequences; method.md 7).
constexpr double kWayInImages = 0.2;

/// [s] longest single prediction of a track; predictions deferred for longer continue from the last
/// scene.
constexpr double kLongStep = 0.5;

/// Mean and covariance of (x, y, vx, vy) over the classes (moment matching).
struct Mixture {
  Vector4 mean = Vector4::Zero();
  Matrix4 covariance = Matrix4::Zero();
};

Mixture mixtureOf(const Track& track, const FilterModel& model, const std::vector<double>& p) {
  Mixture out;
  std::vector<Kinematics> kinematics;
  if (track.decided_class >= 0) {
    const ClassFilter& f = track.bank[static_cast<std::size_t>(track.decided_class)];
    const Kinematics k = kinematicsOf(model.classes[track.decided_class], f);
    const Matrix4 J = k.J.topRows<4>();
    out.mean = k.q.head<4>();
    out.covariance = J * f.P * J.transpose();
    return out;
  }
  for (ClassId j = 0; j < model.classes.size(); ++j) {
    kinematics.push_back(kinematicsOf(model.classes[j], track.bank[static_cast<std::size_t>(j)]));
    out.mean += p[static_cast<std::size_t>(j)] * kinematics.back().q.head<4>();
  }
  for (std::size_t j = 0; j < p.size(); ++j) {
    const Vector4 d = kinematics[j].q.head<4>() - out.mean;
    const Matrix4 J = kinematics[j].J.topRows<4>();
    out.covariance += p[j] * (J * track.bank[j].P * J.transpose() + d * d.transpose());
  }
  return out;
}

double frontProbability(const Track& track, FrontBackAmbiguity bit) {
  if (isOfImagesAlone(track)) bit.traveled *= kWayInImages;
  return bit.frontProbability();
}

}  // namespace

void SceneParams::visit(ParamVisitor& v) {
  v.real("min_existence", min_existence, {0, 1}, "", "objects below are not output");
  v.real("road_user_from", road_user_from, {0, 1}, "",
         "KITTI export: smallest P(exists and is a road user) to be written as a road user");
  v.real("in_image", in_image, {0, 1}, "",
         "KITTI export: smallest share of an object's box inside the image");
  v.real("place_within", place_within, {0, 100}, "",
         "of sqrt(length width): largest position deviation of an output object, with a lidar; 0: "
         "any");
  v.real("place_sigma", place_sigma, {0, 1000}, "m",
         "largest position deviation of an output object; 0: any");
  v.expert();
  v.choiceOf(
      "traffic", traffic, {"right", "left", "unknown"},
      "side of the road that traffic keeps to: heading of standing vehicles of unknown front");
}

std::uint64_t SceneFromPosterior::numberOf(std::uint64_t track_id) {
  const auto [number, fresh] = numbers_.try_emplace(track_id, last_number_ + 1);
  if (fresh) ++last_number_;
  return number->second;
}

std::set<std::uint64_t> SceneFromPosterior::keepOnly(
    const std::unordered_set<std::uint64_t>& tracks) {
  std::unordered_map<std::uint64_t, std::uint64_t> kept;
  std::set<std::uint64_t> ids;
  for (const auto& [track, number] : numbers_) {
    if (tracks.count(track) == 0) continue;
    kept.emplace(track, number);
    ids.insert(number);
  }
  numbers_ = std::move(kept);
  return ids;
}

SceneObject SceneFromPosterior::objectOf(const Track& track) {
  SceneObject o;
  o.id = numberOf(track.id);
  o.class_probability = classProbabilities(track, model_.classes);
  const auto best = static_cast<std::size_t>(
      std::max_element(o.class_probability.begin(), o.class_probability.end()) -
      o.class_probability.begin());
  o.class_id = static_cast<ClassId>(best);
  o.classified = o.class_probability[best] >= params_.classified_at;
  o.existence = track.real();

  const Mixture mixture = mixtureOf(track, model_, o.class_probability);
  o.position << mixture.mean[0], mixture.mean[1], track.base_z.mean;
  o.velocity = mixture.mean.tail<2>();
  o.covariance = (mixture.covariance + mixture.covariance.transpose()) / 2;
  o.sd_x = std::sqrt(mixture.covariance(0, 0));
  o.sd_y = std::sqrt(mixture.covariance(1, 1));

  // What it is may be in doubt; its place and size stay those of what it was seen as.
  const ClassFilter& f = track.bank[static_cast<std::size_t>(track.likeliestClass())];
  const double speed = o.velocity.norm();
  const Vector2 along = speed > 1e-9 ? Vector2(o.velocity / speed) : Vector2(1, 0);
  const Matrix2 velocity_covariance = mixture.covariance.bottomRightCorner<2, 2>();
  o.has_yaw = f.oriented;
  if (f.oriented) {
    o.yaw = f.x[3];
    o.sd_yaw = std::sqrt(f.P(3, 3));
    o.p_front = frontProbability(track, f.heading);
    o.speed = f.x[2];
    o.sd_speed = std::sqrt(f.P(2, 2));
  } else {
    o.speed = speed;
    o.sd_speed = std::sqrt(along.dot(velocity_covariance * along));
    if (track.body_heading) {
      o.has_yaw = true;
      o.yaw = track.body_heading->mean;
      o.sd_yaw = std::min(kPi, std::sqrt(track.body_heading->variance));
      o.p_front = track.body_heading_bit.frontProbability();
    } else if (speed >= kHeadingFromSpeed) {
      const Vector2 across(-along.y(), along.x());
      o.yaw = std::atan2(along.y(), along.x());
      o.sd_yaw = std::min(kPi, std::sqrt(across.dot(velocity_covariance * across)) / speed);
      o.p_front = probabilityForward(o.speed, o.sd_speed * o.sd_speed);
    } else {
      o.yaw = 0;
      o.sd_yaw = kPi;
    }
  }
  o.length = f.extent.length;
  o.width = f.extent.width;
  o.height = track.height.mean;
  const auto& rows = modalities();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (track.last_hit[i].ns != 0) o.last_hit[rows[i].letter] = track.last_hit[i];
  }
  return o;
}

bool SceneFromPosterior::knowsPlace(const SceneObject& o) const {
  const double sigma2 = o.sd_x * o.sd_x + o.sd_y * o.sd_y, size2 = o.length * o.width;
  const double share2 = params_.place_within * params_.place_within,
               most2 = params_.place_sigma * params_.place_sigma;
  return (share2 <= 0 || sigma2 <= share2 * size2) && (most2 <= 0 || sigma2 <= most2);
}

TrackHandle SceneFromPosterior::trackAt(const TrackHandle& track, Stamp stamp) const {
  if (stamp < track->stamp && model_.history > 0) {
    const auto smoothed = smoothedTrack(*track, stamp, model_);
    const double existence = smoothed ? smoothed->real() : -1;
    return existence < params_.min_existence ? nullptr : std::make_shared<const Track>(*smoothed);
  }
  if (predictExistence(*track, stamp, model_) * (1 - track->phantom) < params_.min_existence)
    return nullptr;
  if (stamp <= track->stamp) return track;
  return std::make_shared<const Track>(predictTrack(latestOf(track, stamp), stamp, model_));
}

const Track& SceneFromPosterior::latestOf(const TrackHandle& track, Stamp stamp) const {
  if (stamp - track->stamp <= kLongStep) return *track;
  const auto known = sleepers_.find(track.get());
  return known != sleepers_.end() && known->second.predicted->stamp <= stamp
             ? *known->second.predicted
             : *track;
}

void SceneFromPosterior::keepSleepers(const std::vector<TrackHandle>& tracks,
                                      const std::vector<TrackHandle>& predicted) {
  sleepers_.clear();
  for (std::size_t i = 0; i < predicted.size(); ++i) {
    const TrackHandle& track = tracks[i];
    if (predicted[i] && predicted[i]->stamp > track->stamp)
      sleepers_[track.get()] = {track, predicted[i]};
  }
}

Scene SceneFromPosterior::make(const Hypothesis& hypothesis, const EgoState& ego,
                               std::int64_t frame) {
  Scene scene;
  scene.stamp = ego.stamp;
  scene.frame = frame;
  scene.ego = ego;
  std::vector<TrackHandle> sources(hypothesis.tracks.begin(), hypothesis.tracks.end());
  for (const EndedTrack& e : hypothesis.ended)
    if (ego.stamp < e.end) sources.push_back(e.track);
  std::vector<TrackHandle> tracks(sources.size());
  parallelFor(tracks.size(), [&](std::size_t i) { tracks[i] = trackAt(sources[i], ego.stamp); });
  keepSleepers(sources, tracks);
  for (const auto& track : tracks) {
    if (!track) continue;
    SceneObject object = objectOf(*track);
    if (knowsPlace(object)) scene.objects.push_back(std::move(object));
  }
  std::sort(scene.objects.begin(), scene.objects.end(),
            [](const SceneObject& a, const SceneObject& b) { return a.id < b.id; });
  if (model_.params.heading == HeadingMode::kSplit)
    turnUntoldFronts(ego, params_.traffic, model_.classes, scene.objects);
  return scene;
}

}  // namespace perception
