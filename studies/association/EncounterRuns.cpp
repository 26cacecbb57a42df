#include "studies/association/EncounterRuns.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "libperception/core/math/Assignment.h"
#include "libperception/evaluation/metrics/SetDistance.h"
#include "libperception/filter/CRbpfTracker.h"
#include "libperception/scene/SceneFromPosterior.h"

namespace perception {
namespace {

constexpr double kCutoff = 2;        // [m]
constexpr std::size_t kWarmUp = 10;  // instants: 1 s

/// By truth object the id of the estimate that is assigned to it within the cut-off; 0: none.
std::vector<std::uint64_t> matchIds(const std::vector<Vector2>& truth, const Scene& scene) {
  std::vector<std::uint64_t> ids(truth.size(), 0);
  const std::size_t n = scene.objects.size();
  if (truth.empty() || n == 0) return ids;
  Eigen::MatrixXd cost(truth.size(), n);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      cost(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = std::min(
          kCutoff * kCutoff, (truth[i] - scene.objects[j].position.head<2>()).squaredNorm());
    }
  }
  const auto columns = optimalAssignment(cost);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const int j = columns[i];
    if (j >= 0 && cost(static_cast<Eigen::Index>(i), j) < kCutoff * kCutoff)
      ids[i] = scene.objects[static_cast<std::size_t>(j)].id;
  }
  return ids;
}

std::uint64_t dominant(const std::vector<std::uint64_t>& ids) {
  std::map<std::uint64_t, int> count;
  for (const auto id : ids) ++count[id];
  return std::max_element(count.begin(), count.end(),
                          [](auto& a, auto& b) { return a.second < b.second; })
      ->first;
}

/// Accumulates the metrics of a run.
class Scorer {
 public:
  explicit Scorer(const EncounterScene& scene)
      : scene_(scene), before_(scene.objects.size()), after_(scene.objects.size()) {}

  void add(std::size_t k, const Scene& estimate) {
    std::vector<Vector2> truth, estimates;
    std::vector<std::size_t> who;
    for (std::size_t i = 0; i < scene_.objects.size(); ++i) {
      if (!encounterInView(scene_.objects[i].path[k])) continue;
      truth.push_back(scene_.objects[i].path[k]);
      who.push_back(i);
    }
    // Only estimates within the field of view are compared, as truth.
    int classified = 0;
    for (const auto& o : estimate.objects) {
      if (!encounterInView(o.position.head<2>())) continue;
      estimates.push_back(o.position.head<2>());
      classified += o.classified;
    }
    squares_ += gospa(truth, estimates, kCutoff).squared();
    score_.count.push_back(static_cast<int>(estimates.size()));
    score_.classified.push_back(classified);
    score_.truth_count.push_back(static_cast<int>(truth.size()));
    if (k < kWarmUp) return;
    const auto ids = matchIds(truth, estimate);
    for (std::size_t i = 0; i < ids.size(); ++i) {
      ++instants_;
      if (ids[i] == 0) continue;
      ++tracked_;
      if (3 * k < scene_.instants()) before_[who[i]].push_back(ids[i]);
      if (10 * k >= 6 * scene_.instants()) after_[who[i]].push_back(ids[i]);
    }
  }

  EncounterScore finish() {
    for (std::size_t i = 0; i < before_.size(); ++i) {
      if (!before_[i].empty() && !after_[i].empty())
        score_.swapped = score_.swapped || dominant(before_[i]) != dominant(after_[i]);
    }
    score_.gospa = std::sqrt(squares_ / static_cast<double>(score_.count.size()));
    score_.tracked = tracked_ / std::max(1.0, instants_);
    return score_;
  }

 private:
  const EncounterScene& scene_;
  std::vector<std::vector<std::uint64_t>> before_, after_;
  EncounterScore score_;
  double squares_ = 0, tracked_ = 0, instants_ = 0;
};

}  // namespace

FilterModel encounterModel(Proposal proposal) {
  FilterModel model;
  model.classes = encounterClasses();
  ObjectClass& pedestrian = model.classes.classes[0];
  pedestrian.mode_accel_psd = {0.04, 0.5};  // walking ([radecki2016]'s .04) and stopping or turning
  pedestrian.mode_damping = {0, 3};
  pedestrian.mode_sojourn = {4, 1.5};  // method.md 3.6
  model.params.kinematic_exponent = 1;
  model.proposal = proposal;
  return model;
}

EncounterScore runEncounter(const std::string& name, const EncounterConditions& conditions,
                            const FilterModel& model, int particles, std::uint64_t seed,
                            std::uint64_t filter_seed) {
  Rng world({seed, 0, 0, 1}), sensors({seed, 0, 0, 2});
  const auto scene = encounterScene(name, world);
  const auto scans = simulateEncounter(scene, conditions, sensors);
  ParticleFilterParams pf;
  pf.sample_size = particles;
  CRbpfTracker tracker(model, pf.toMrpt(), filter_seed);
  SceneFromPosterior output(model, {});
  Scorer scorer(scene);
  for (std::size_t s = 0; s < scans.size(); ++s) {
    tracker.process(scans[s]);
    if (s + 1 < scans.size() && scans[s + 1].frame == scans[s].frame) continue;
    scorer.add(static_cast<std::size_t>(scans[s].frame),
               output.make(tracker.mapHypothesis(), scans[s].state.ego, scans[s].frame));
  }
  return scorer.finish();
}

}  // namespace perception
