#include "libperception/evaluation/metrics/Evaluation.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "libperception/evaluation/matching/SeenObjects.h"
#include "libperception/evaluation/metrics/ExistenceSamples.h"

namespace perception {
namespace {

// Ranges of [radecki2016]'s camera (method.md 11; table on camera resolution of [radecki2016], 2k
// images) [m].
constexpr double kCameraCarRange = 15, kCameraPersonRange = 10;

std::string sensorSet(const TrackedRun& run) {
  std::set<char> letters;
  for (const Scene& scene : run.scenes) {
    for (const SceneObject& object : scene.objects) {
      for (const auto& hit : object.last_hit) letters.insert(letterOf(hit.first));
    }
  }
  return {letters.begin(), letters.end()};
}

Match makeMatch(const SeenTruth& truth, const SeenEstimate& estimate) {
  const SceneObject& e = *estimate.object;
  const TruthObject& t = *truth.object;
  Match match;
  match.id = e.id;
  match.class_id = e.class_id;
  match.classified = e.classified;
  match.probability = e.class_probability[static_cast<std::size_t>(e.class_id)];
  match.distance = (estimate.footprint.center - truth.footprint.center).norm();
  match.view = estimate.view;
  if (std::isfinite(t.vx) && std::isfinite(t.vy)) {
    match.speed_error = e.velocity.norm() - std::hypot(t.vx, t.vy);
    match.velocity_error = (e.velocity - Vector2(t.vx, t.vy)).norm();
  }
  if (e.has_yaw && std::isfinite(t.yaw)) match.heading_error = wrapAngle(e.yaw - t.yaw);
  match.front_probability = e.p_front;
  return match;
}

// All steps for one run.
class Evaluator {
 public:
  Evaluator(const TrackedRun& run, const EvaluationOptions& options)
      : run_(run), options_(options) {
    result_.class_names = run.class_names;
    for (const std::string& name : run.class_names) {
      result_.named.push_back(std::find(options.unnamed.begin(), options.unnamed.end(), name) ==
                              options.unnamed.end());
    }
    result_.sensors = options.sensors.empty() ? sensorSet(run) : options.sensors;
  }

  void add(const TruthAtScene& instant) {
    const Scene& scene = run_.scenes[instant.scene];
    std::vector<SeenEstimate> estimates = seenEstimates(scene);
    std::vector<SeenTruth> counted, others;
    for (const TruthObject& object : instant.objects) {
      SeenTruth seen = see(object, scene);
      ++result_.truth_use[static_cast<std::size_t>(seen.use)];
      (seen.use == TruthUse::kCounts ? counted : others).push_back(seen);
    }
    InstantFigures figures;
    figures.frame = scene.frame;
    figures.t = scene.stamp - run_.first_stamp;
    figures.truth = counted.size();
    std::vector<SeenTruth> truth = counted;
    truth.insert(truth.end(), others.begin(), others.end());
    for (const ExistenceSample& sample : realness(estimates, truth))
      result_.existence.push_back(sample);
    estimates.erase(std::remove_if(estimates.begin(), estimates.end(),
                                   [&](const SeenEstimate& e) {
                                     return e.object->existence < options_.min_existence;
                                   }),
                    estimates.end());
    for (const ExistenceSample& sample : realness(estimates, truth))
      figures.not_real += !sample.real;
    countOutputs(estimates, truth, figures);
    setDistances(estimates, counted, others, figures);
    addSamples(estimates, counted, figures.t);
    result_.instants.push_back(std::move(figures));
  }

  Evaluation take() { return std::move(result_); }

 private:
  SeenTruth see(const TruthObject& object, const Scene& scene) const {
    SeenTruth seen = seenTruth(object, scene.ego.T_world_ego, run_.class_names, options_.selection);
    // Truth objects of unnamed classes do not count, as outputs of these.
    if (seen.use == TruthUse::kCounts && !isNamed(seen.class_id)) seen.use = TruthUse::kNoClass;
    return seen;
  }

  bool isNamed(ClassId c) const { return result_.named[static_cast<std::size_t>(c)]; }
  // Region in which outputs can be false: the sector, where the truth is complete.
  bool isNamedInSector(const SeenEstimate& e) const {
    const SelectionOptions& o = options_.selection;
    return isNamed(e.object->class_id) &&
           inSector(e.view, o.range, std::min(o.fov, o.complete_fov));
  }
  bool anyNear(const std::vector<SeenTruth>& truth, const SeenEstimate& e) const {
    return std::any_of(truth.begin(), truth.end(), [&](const SeenTruth& t) {
      return isNear(t, e.footprint.center, options_.exclusion);
    });
  }

  void countOutputs(const std::vector<SeenEstimate>& estimates, const std::vector<SeenTruth>& truth,
                    InstantFigures& figures) const {
    figures.outputs.resize(result_.class_names.size());
    for (const SeenEstimate& e : estimates) {
      if (!isNamedInSector(e)) continue;
      const bool is_false = !anyNear(truth, e);
      OutputCounts& counts = figures.outputs[static_cast<std::size_t>(e.object->class_id)];
      ++counts.named;
      if (is_false) {
        ++counts.false_;
        figures.false_objects.push_back({e.object->id, e.object->class_id, e.object->classified});
      }
      if (!e.object->classified) continue;
      ++counts.classified_named;
      if (is_false) ++counts.classified_false;
    }
  }

  std::vector<ExistenceSample> realness(const std::vector<SeenEstimate>& estimates,
                                        const std::vector<SeenTruth>& truth) const {
    std::vector<SeenEstimate> named;
    for (const SeenEstimate& e : estimates) {
      if (isNamedInSector(e)) named.push_back(e);
    }
    return existenceSamples(named, truth, options_, result_.instants.size());
  }

  // The truth set is the counted one. Its estimates: of named classes, those that pair with it
  // one-to-one wherever they stand, and of the rest those inside the sector and not near a truth
  // object that does not count.
  void setDistances(const std::vector<SeenEstimate>& estimates,
                    const std::vector<SeenTruth>& counted, const std::vector<SeenTruth>& others,
                    InstantFigures& figures) const {
    std::vector<SeenEstimate> named;
    for (const SeenEstimate& e : estimates) {
      if (isNamed(e.object->class_id)) named.push_back(e);
    }
    std::vector<bool> paired(named.size(), false);
    for (const int e :
         match(centers(counted), centers(named), options_.cutoff, Pairing::kOneToOne)) {
      if (e >= 0) paired[static_cast<std::size_t>(e)] = true;
    }
    std::vector<Vector2> set;
    std::vector<std::uint64_t> ids;
    for (std::size_t i = 0; i < named.size(); ++i) {
      if (paired[i] || (isNamedInSector(named[i]) && !anyNear(others, named[i]))) {
        set.push_back(named[i].footprint.center), ids.push_back(named[i].object->id);
      }
    }
    figures.estimates = set.size();
    figures.gospa = gospa(centers(counted), set, options_.cutoff);
    figures.ospa = ospa(centers(counted), set, options_.cutoff);
    std::vector<std::int64_t> truth_ids;
    for (const SeenTruth& truth : counted) truth_ids.push_back(truth.object->id);
    figures.identities = identityView(truth_ids, centers(counted), ids, set, options_.tolerance);
  }

  // Denominator B: truth within the range of the sensor set. A lidar covers the sector; without
  // one, the camera's range limits it (method.md 11), also with radar.
  bool inSensorRange(const SeenTruth& truth) const {
    const std::string& sensors = result_.sensors;
    const auto covers = [](char letter) {
      const auto* row = findModality(letter);  // null: the sign between letters
      return row && row->covers_sector;
    };
    if (sensors.empty() || std::any_of(sensors.begin(), sensors.end(), covers)) return true;
    const std::string& name = result_.class_names[static_cast<std::size_t>(truth.class_id)];
    const bool person = name == "pedestrian" || name == "cyclist";
    return truth.view.range <= (person ? kCameraPersonRange : kCameraCarRange);
  }

  void addSamples(const std::vector<SeenEstimate>& estimates, const std::vector<SeenTruth>& counted,
                  double t) {
    std::array<std::vector<int>, kPairings> pairs;
    for (int p = 0; p < kPairings; ++p) {
      pairs[static_cast<std::size_t>(p)] =
          match(centers(counted), centers(estimates), options_.tolerance, static_cast<Pairing>(p));
    }
    for (std::size_t i = 0; i < counted.size(); ++i) {
      const SeenTruth& truth = counted[i];
      TruthSample sample;
      sample.instant = result_.instants.size();
      sample.t = t;
      sample.id = truth.object->id;
      sample.type = truth.object->type;
      sample.class_id = truth.class_id;
      sample.view = truth.view;
      if (std::isfinite(truth.object->vx) && std::isfinite(truth.object->vy))
        sample.speed = std::hypot(truth.object->vx, truth.object->vy);
      sample.in_sensor_range = inSensorRange(truth);
      for (std::size_t p = 0; p < pairs.size(); ++p) {
        const int e = pairs[p][i];
        if (e >= 0) sample.match[p] = makeMatch(truth, estimates[static_cast<std::size_t>(e)]);
      }
      result_.samples.push_back(std::move(sample));
    }
  }

  const TrackedRun& run_;
  const EvaluationOptions& options_;
  Evaluation result_;
};

}  // namespace

OutputCounts& OutputCounts::operator+=(const OutputCounts& other) {
  named += other.named;
  false_ += other.false_;
  classified_named += other.classified_named;
  classified_false += other.classified_false;
  return *this;
}

OutputCounts InstantFigures::allOutputs() const {
  OutputCounts sum;
  for (const OutputCounts& counts : outputs) sum += counts;
  return sum;
}

Evaluation evaluate(const TrackedRun& run, const GroundTruth& truth,
                    const EvaluationOptions& options) {
  TruthAlignment alignment = alignTruth(run, truth, options.alignment);
  Evaluator evaluator(run, options);
  for (const TruthAtScene& instant : alignment.instants) evaluator.add(instant);
  alignment.instants.clear();
  Evaluation evaluation = evaluator.take();
  evaluation.alignment = std::move(alignment);
  return evaluation;
}

}  // namespace perception
