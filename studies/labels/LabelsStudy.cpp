#include "studies/labels/LabelsStudy.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <map>

#include "libperception/core/Error.h"
#include "studies/labels/LabelsReport.h"

namespace perception {
namespace {

constexpr std::uint32_t kDamagePurpose = 0x1abe15;  // of the random numbers

std::vector<LabelCondition> conditionsOf(const LabelsParams& params) {
  std::vector<LabelCondition> conditions;
  const auto add = [&](LabelNoise::Kind kind, double p) {
    conditions.push_back({{kind, p}, kJointTracker, {}});
    if (kind != LabelNoise::kDropped || p < 1)
      conditions.push_back({{kind, p}, kTrackerPerClass, {}});
    if (kind == LabelNoise::kDropped) conditions.push_back({{kind, p}, kTrackerPerClassAll, {}});
  };
  add(LabelNoise::kNone, 0);
  for (const double p : params.shares) add(LabelNoise::kDropped, p);
  add(LabelNoise::kDropped, 1);
  for (const double p : params.shares) add(LabelNoise::kFlipped, p);
  return conditions;
}

// Data common to all runs of one log.
struct LogFacts {
  bool simulated = false;
  GroundTruth truth;              // objects of classes without a label are ignored
  std::vector<ClassId> classes;   // by label
  std::vector<bool> road_user;    // by class
  std::vector<int> measurements;  // by sample: index of the object's measurement, from 1
};

// The measurements of a log as outputs, to count detections of each truth object.
TrackedRun seenRun(const RecordedLog& log) {
  TrackedRun run;
  run.first_stamp = log.first_stamp;
  for (const ObjectClass& c : log.model.classes.classes) run.class_names.push_back(c.name);
  std::vector<SceneObject> seen;
  for (const RecordedLog::Entry& entry : log.entries) {
    if (entry.kind == RecordedLog::Entry::kScan) {
      for (const Measurement& m : entry.scan->measurements) {
        SceneObject o;
        o.id = seen.size() + 1;
        o.class_probability.assign(run.class_names.size(), 0);
        o.class_probability[0] = o.existence = 1;
        o.position.head<2>() = m.position;
        seen.push_back(std::move(o));
      }
    } else if (entry.kind == RecordedLog::Entry::kScene) {
      Scene scene;
      scene.stamp = entry.ego.stamp;
      scene.frame = entry.frame;
      scene.ego = entry.ego;
      scene.objects = std::move(seen);
      seen.clear();
      run.scenes.push_back(std::move(scene));
    }
  }
  return run;
}

LogFacts factsOf(const LabeledLog& log, const LabelsParams& params) {
  const RecordedLog recorded = log.record([](ObjectDetections&, Stamp) {});
  LogFacts facts;
  facts.simulated = recorded.simulated;
  const ClassTable& classes = recorded.model.classes;
  for (ClassId c = 0; c < classes.size(); ++c) facts.road_user.push_back(classes[c].reported);
  for (const std::string& label : params.labels) {
    ClassId of = -1;
    for (ClassId c = classes.size() - 1; c >= 0; --c) {
      if (classes[c].kitti_type == label) of = c;
    }
    if (of < 0) throw DataError("no class has the kitti_type '" + label + "' of the detector");
    facts.classes.push_back(of);
  }
  const TrackedRun seen = seenRun(recorded);
  facts.truth = log.truth;
  for (auto& instant : facts.truth.instants) {
    for (TruthObject& o : instant.objects) {
      const ClassId c = classOfTruth(o.type, seen.class_names);
      o.ignore = o.ignore || !std::count(facts.classes.begin(), facts.classes.end(), c);
    }
  }
  std::map<std::int64_t, int> count;
  for (const TruthSample& s : evaluate(seen, facts.truth, params.evaluation).samples)
    facts.measurements.push_back(s.matched(Pairing::kOneToOne) ? ++count[s.id] : 0);
  return facts;
}

void add(const LabelScore& part, LabelScore& sum) {
  if (sum.of_class.empty()) {
    sum = part;
    return;
  }
  addClear(part.any_class, sum.any_class);
  for (std::size_t l = 0; l < part.of_class.size(); ++l) {
    addClear(part.of_class[l], sum.of_class[l]);
    for (std::size_t k = 0; k < part.objects[l].size(); ++k) {
      sum.objects[l][k] += part.objects[l][k];
      sum.right[l][k] += part.right[l][k];
    }
  }
}

// One log, corrupted and tracked in one way.
TrackedRun track(const LabeledLog& log, std::size_t number, const LogFacts& facts,
                 const LabelCondition& condition, const LabelsParams& params) {
  const auto run = [&](const std::string& label, ClassId forced) {
    const RecordedLog recorded = log.record([&](ObjectDetections& detections, Stamp stamp) {
      const RngKey key = {params.seed, static_cast<std::uint64_t>(stamp.ns),
                          static_cast<std::uint32_t>(number), kDamagePurpose};
      corruptLabels(condition.damage, params.labels, params.group_distance, key, detections);
      if (!label.empty()) keepLabel(label, condition.method.takes_unlabeled, detections);
    });
    const ReplayMethod method = {recorded.model.proposal,
                                 static_cast<int>(recorded.particles.sample_size), params.seed,
                                 false};
    return roadUsers(replay(recorded, method), facts.road_user, facts.classes, params.least_output,
                     forced);
  };
  if (!condition.method.per_class) return run("", -1);
  std::vector<TrackedRun> runs;
  for (std::size_t l = 0; l < params.labels.size(); ++l)
    runs.push_back(run(params.labels[l], facts.classes[l]));
  return joined(runs);
}

}  // namespace

TrackedRun roadUsers(const TrackedRun& run, const std::vector<bool>& is_road_user,
                     const std::vector<ClassId>& classes, double least_output, ClassId forced) {
  TrackedRun out = run;
  for (Scene& scene : out.scenes) {
    std::vector<SceneObject> kept;
    for (SceneObject& o : scene.objects) {
      const auto p = [&](ClassId c) { return o.class_probability[static_cast<std::size_t>(c)]; };
      double road_user = 0;
      for (std::size_t c = 0; c < is_road_user.size(); ++c) {
        if (is_road_user[c]) road_user += o.class_probability[c];
      }
      if (o.existence * road_user < least_output) continue;
      o.existence *= road_user;
      o.class_id = forced >= 0
                       ? forced
                       : *std::max_element(classes.begin(), classes.end(),
                                           [&](ClassId a, ClassId b) { return p(a) < p(b); });
      kept.push_back(std::move(o));
    }
    scene.objects = std::move(kept);
  }
  return out;
}

TrackedRun joined(const std::vector<TrackedRun>& runs) {
  TrackedRun out = runs.front();
  for (Scene& scene : out.scenes) scene.objects.clear();
  for (std::size_t r = 0; r < runs.size(); ++r) {
    if (runs[r].scenes.size() != out.scenes.size())
      throw DataError(out.dir + ": runs of one log with different scenes");
    for (std::size_t k = 0; k < out.scenes.size(); ++k) {
      for (SceneObject o : runs[r].scenes[k].objects) {
        o.id = o.id * runs.size() + r;
        out.scenes[k].objects.push_back(std::move(o));
      }
    }
  }
  for (Scene& scene : out.scenes) {
    std::sort(scene.objects.begin(), scene.objects.end(),
              [](const SceneObject& a, const SceneObject& b) { return a.id < b.id; });
  }
  return out;
}

LabelScore scoreLabels(const TrackedRun& run, const GroundTruth& truth,
                       const std::vector<int>& numbers, const std::vector<ClassId>& classes,
                       const LabelsParams& params) {
  LabelScore score;
  EvaluationOptions options = params.evaluation;
  options.exclusion = options.tolerance;  // CLEAR: every output is matched, ignored or false
  const Evaluation all = evaluate(run, truth, options);
  if (all.samples.size() != numbers.size())
    throw DataError(run.dir + ": other objects count than were seen");
  score.any_class = clearFigures(all);
  const auto last = static_cast<std::size_t>(params.last_measurement);
  score.objects.assign(classes.size(), std::vector<std::size_t>(last, 0));
  score.right = score.objects;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (numbers[i] < 1 || numbers[i] > params.last_measurement) continue;
    const TruthSample& sample = all.samples[i];
    const auto label = static_cast<std::size_t>(
        std::find(classes.begin(), classes.end(), sample.class_id) - classes.begin());
    const auto k = static_cast<std::size_t>(numbers[i] - 1);
    const auto& match = sample.matched(Pairing::kOneToOne);
    ++score.objects[label][k];
    score.right[label][k] += match && match->class_id == sample.class_id;
  }
  for (const ClassId c : classes) {
    TrackedRun of_class = run;
    for (Scene& scene : of_class.scenes) {
      auto& objects = scene.objects;
      objects.erase(std::remove_if(objects.begin(), objects.end(),
                                   [&](const SceneObject& o) { return o.class_id != c; }),
                    objects.end());
    }
    GroundTruth truth_of_class = truth;
    for (auto& instant : truth_of_class.instants) {
      auto& objects = instant.objects;
      objects.erase(std::remove_if(objects.begin(), objects.end(),
                                   [&](const TruthObject& o) {
                                     return !o.ignore && classOfTruth(o.type, run.class_names) != c;
                                   }),
                    objects.end());
    }
    score.of_class.push_back(clearFigures(evaluate(of_class, truth_of_class, options)));
  }
  return score;
}

StudyReport labelsStudy(const LabelsParams& params, const std::vector<LabeledLog>& logs) {
  std::vector<LogFacts> facts(logs.size());
  tbb::parallel_for(std::size_t{0}, logs.size(),
                    [&](std::size_t i) { facts[i] = factsOf(logs[i], params); });
  std::vector<LabelCondition> conditions = conditionsOf(params);
  std::vector<LabelScore> scores(conditions.size() * logs.size());
  tbb::parallel_for(
      std::size_t{0}, scores.size(),
      [&](std::size_t job) {
        const std::size_t c = job % conditions.size(), l = job / conditions.size();
        scores[job] = scoreLabels(track(logs[l], l, facts[l], conditions[c], params),
                                  facts[l].truth, facts[l].measurements, facts[l].classes, params);
      },
      tbb::simple_partitioner());
  for (std::size_t job = 0; job < scores.size(); ++job)
    add(scores[job], conditions[job % conditions.size()].score);

  StudyReport report;
  report.title = "What a detector's labels are worth";
  std::string names;
  bool simulated = false;
  for (std::size_t l = 0; l < logs.size(); ++l) {
    names += (l ? ", " : "") + logs[l].name;
    simulated = simulated || facts[l].simulated;
  }
  const std::string plural = logs.size() == 1 ? "" : "s";
  report.data = fmt::format("{}log{} {}", simulated ? "simulated " : "", plural, names);
  const std::string where =
      fmt::format("{} {}log{}", logs.size(), simulated ? "simulated " : "", plural);
  describeLabels(params, conditions, where, report);
  return report;
}

}  // namespace perception
