#include "studies/association/ObjectCounts.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace perception {
namespace {

void fillCdf(const std::vector<int>& a, const std::vector<int>& b, std::vector<double>& cdf) {
  cdf.assign(kLargestError + 1, 0);
  const std::size_t n = std::min(a.size(), b.size());
  for (std::size_t k = 0; k < n; ++k) {
    const auto error = static_cast<std::size_t>(std::abs(a[k] - b[k]));
    for (std::size_t i = error; i <= kLargestError; ++i) cdf[i] += 1;
  }
  for (double& share : cdf) share /= std::max<double>(1, static_cast<double>(n));
}

double rms(const std::vector<int>& a, const std::vector<int>& b) {
  const std::size_t n = std::min(a.size(), b.size());
  double sum = 0;
  for (std::size_t k = 0; k < n; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
  return std::sqrt(sum / std::max<double>(1, static_cast<double>(n)));
}

// Poles and hedges count as road users do; walls are not in the truth. One-to-one matching.
void countThings(const TrackedRun& run, const GroundTruth& truth, const EvaluationOptions& options,
                 CountedRun& counted) {
  constexpr double kOverhead = 2;  // [m] above the vehicle's ground: crowns of trees
  for (const TruthAtScene& instant : alignTruth(run, truth, options.alignment).instants) {
    const Scene& scene = run.scenes[instant.scene];
    const Pose3& ego = scene.ego.T_world_ego;
    std::vector<Vector2> things, outputs;
    for (TruthObject object : instant.objects) {
      const Footprint footprint =
          makeFootprint(object.position, object.yaw, object.length, object.width);
      const bool area = isArea(object) || object.position.z() - ego.translation().z() > kOverhead;
      object.ignore = false;
      const TruthUse use = useOf(object, viewFrom(ego, footprint), 0, options.selection);
      if (!area && use == TruthUse::kCounts) things.push_back(footprint.center);
    }
    for (const SceneObject& o : scene.objects) outputs.emplace_back(o.position.head<2>());
    int held = 0;
    for (const int output : match(things, outputs, options.tolerance, Pairing::kOneToOne))
      held += output >= 0;
    counted.things.push_back(static_cast<int>(things.size()));
    counted.held.push_back(held);
  }
}

}  // namespace

CountedRun countObjects(const TrackedRun& run, const GroundTruth* truth,
                        const EvaluationOptions& options) {
  CountedRun counted;
  std::vector<bool> named;
  for (const std::string& name : run.class_names) {
    named.push_back(std::find(options.unnamed.begin(), options.unnamed.end(), name) ==
                    options.unnamed.end());
  }
  double cars = 0, persons = 0;
  for (const Scene& scene : run.scenes) {
    int all = 0, classified = 0;
    for (const SceneObject& o : scene.objects) {
      // The output may contain objects left far behind: only those in the sector count.
      const GroundView view =
          viewFrom(scene.ego.T_world_ego, makeFootprint(o.position, o.yaw, o.length, o.width));
      if (!inSector(view, options.selection.range, options.selection.fov)) continue;
      ++all;
      const auto c = static_cast<std::size_t>(o.class_id);
      if (!o.classified || !named[c]) continue;
      ++classified;
      cars += run.class_names[c] == "car";
      persons += run.class_names[c] == "pedestrian";
    }
    counted.all.push_back(all);
    counted.classified.push_back(classified);
  }
  const double scenes = std::max<double>(1, static_cast<double>(run.scenes.size()));
  counted.mean_cars = cars / scenes;
  counted.mean_persons = persons / scenes;
  if (!truth) return counted;
  counted.evaluation = evaluate(run, *truth, options);
  countThings(run, *truth, options, counted);
  return counted;
}

CountErrors compareCounts(const CountedRun& run, const CountedRun& reference) {
  CountErrors e;
  e.all = rms(run.all, reference.all);
  e.classified = rms(run.classified, reference.classified);
  fillCdf(run.all, reference.all, e.cdf_all);
  fillCdf(run.classified, reference.classified, e.cdf_classified);
  if (run.evaluation && !run.evaluation->instants.empty()) {
    double sum = 0, squares = 0;
    for (const InstantFigures& i : run.evaluation->instants) {
      const double d = static_cast<double>(i.estimates) - static_cast<double>(i.truth);
      sum += d, squares += d * d;
    }
    const auto n = static_cast<double>(run.evaluation->instants.size());
    e.truth = std::sqrt(squares / n);
    e.truth_bias = sum / n;
    e.unheld = rms(run.things, run.held);
  }
  return e;
}

}  // namespace perception
