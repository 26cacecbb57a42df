#include "studies/association/EncounterRuns.h"

#include <cmath>

#include "libperception/evaluation/metrics/SetDistance.h"
#include "libperception/filter/CRbpfTracker.h"
#include "libperception/scene/SceneFromPosterior.h"

namespace perception {
namespace {

constexpr double kCutoff = 2;  // [m]

/// Accumulates the metrics of a run.
class Scorer {
 public:
  explicit Scorer(const EncounterScene& scene) : scene_(scene) {}

  /// Truth and estimates within the field of view are compared.
  void add(std::size_t k, const Scene& estimate) {
    std::vector<Vector2> truth, estimates;
    for (const EncounterScene::Object& object : scene_.objects)
      if (encounterInView(object.path[k])) truth.push_back(object.path[k]);
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
  }

  EncounterScore finish() {
    score_.gospa = std::sqrt(squares_ / static_cast<double>(score_.count.size()));
    return score_;
  }

 private:
  const EncounterScene& scene_;
  EncounterScore score_;
  double squares_ = 0;
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

EncounterScore runEncounter(const EncounterScene& scene, const EncounterConditions& conditions,
                            const FilterModel& model, int particles, std::uint64_t seed,
                            std::uint64_t filter_seed,
                            const std::function<void(std::size_t, const Scene&)>& see) {
  Rng sensors({seed, 0, 0, 2});
  const auto scans = simulateEncounter(scene, conditions, sensors);
  ParticleFilterParams pf;
  pf.sample_size = particles;
  CRbpfTracker tracker(model, pf.toMrpt(), filter_seed);
  SceneFromPosterior output(model, {});
  Scorer scorer(scene);
  for (std::size_t s = 0; s < scans.size(); ++s) {
    tracker.process(scans[s]);
    if (s + 1 < scans.size() && scans[s + 1].frame == scans[s].frame) continue;
    const Scene estimate = output.make(tracker.mapHypothesis(), scans[s].state.ego, scans[s].frame);
    scorer.add(static_cast<std::size_t>(scans[s].frame), estimate);
    if (see) see(static_cast<std::size_t>(scans[s].frame), estimate);
  }
  return scorer.finish();
}

}  // namespace perception
