#include "libperception/calibration/TracksAsTruth.h"

#include <algorithm>
#include <map>

#include "libperception/evaluation/matching/TruthAlignment.h"
#include "libperception/evaluation/matching/TruthSelection.h"

namespace perception {
namespace {

constexpr double kLeastLife = 1;         // [s] with existence as below
constexpr double kLeastExistence = 0.9;  // at a scene
constexpr double kLeastClass = 0.8;      // mean probability of the likeliest class
constexpr double kNearLabel = 2;         // [m] of a label: a track of the same object
constexpr const char* kThing = "static-other";
constexpr const char* kUnknown = "unknown";

/// A track from its first scene to its last.
struct Life {
  Stamp first, last_hit;
  Stamp first_sure, last_sure;  ///< scenes with kLeastExistence
  std::vector<double> classes;  ///< sums of probabilities
  std::size_t scenes = 0;
};

std::map<std::uint64_t, Life> livesOf(const TrackedRun& run) {
  std::map<std::uint64_t, Life> lives;
  for (const Scene& scene : run.scenes) {
    for (const SceneObject& o : scene.objects) {
      Life& life = lives[o.id];
      if (life.scenes == 0) {
        life.first = scene.stamp;
        life.classes.assign(o.class_probability.size(), 0);
      }
      ++life.scenes;
      for (std::size_t c = 0; c < life.classes.size(); ++c)
        life.classes[c] += o.class_probability[c];
      for (const auto& [modality, stamp] : o.last_hit)
        life.last_hit = std::max(life.last_hit, stamp);
      if (o.existence < kLeastExistence) continue;
      if (life.first_sure.ns == 0) life.first_sure = scene.stamp;
      life.last_sure = scene.stamp;
    }
  }
  return lives;
}

std::string typeOf(const Life& life, const std::vector<std::string>& classes) {
  const auto best = std::max_element(life.classes.begin(), life.classes.end());
  const bool sure = best != life.classes.end() && life.last_sure - life.first_sure >= kLeastLife &&
                    *best >= kLeastClass * static_cast<double>(life.scenes);
  return sure ? classes[static_cast<std::size_t>(best - life.classes.begin())] : kUnknown;
}

TruthObject labelOf(const SceneObject& o, const std::string& type, double t, int occluded) {
  TruthObject label;
  label.t = t;
  label.id = static_cast<std::int64_t>(o.id);
  label.type = type;
  label.position = o.position;
  label.yaw = o.yaw;
  label.length = o.length, label.width = o.width, label.height = o.height;
  label.vx = o.velocity.x(), label.vy = o.velocity.y();
  label.occluded = occluded;
  return label;
}

}  // namespace

GroundTruth tracksAsTruth(const TrackedRun& run, int occluded) {
  const auto lives = livesOf(run);
  GroundTruth truth;
  for (const Scene& scene : run.scenes) {
    GroundTruth::Instant instant;
    instant.frame = scene.frame;
    instant.t = scene.stamp - run.first_stamp;
    for (const SceneObject& o : scene.objects) {
      const Life& life = lives.at(o.id);
      TruthObject label = labelOf(o, typeOf(life, run.class_names), instant.t, occluded);
      label.frame = scene.frame;
      label.ignore = scene.stamp <= life.first || scene.stamp >= life.last_hit;
      instant.objects.push_back(std::move(label));
    }
    truth.instants.push_back(std::move(instant));
  }
  return truth;
}

GroundTruth withTracks(const GroundTruth& labeled, const TrackedRun& run, int occluded) {
  const GroundTruth tracks = tracksAsTruth(run, occluded);
  GroundTruth truth;
  for (TruthAtScene& known : alignTruth(run, labeled, {}).instants) {
    GroundTruth::Instant instant = tracks.instants[known.scene];
    auto& own = instant.objects;
    const auto isLabeled = [&](const TruthObject& track) {
      return std::any_of(known.objects.begin(), known.objects.end(), [&](const TruthObject& o) {
        return !isArea(o) && (o.position.head<2>() - track.position.head<2>()).norm() <
                                 std::max(kNearLabel, 0.5 * o.length);
      });
    };
    own.erase(std::remove_if(own.begin(), own.end(), isLabeled), own.end());
    for (TruthObject& track : own) {
      track.id = -1 - track.id;  // apart from those of labels
      if (track.type != kThing) track.type = kUnknown;
    }
    own.insert(own.end(), known.objects.begin(), known.objects.end());
    truth.instants.push_back(std::move(instant));
  }
  return truth;
}

}  // namespace perception
