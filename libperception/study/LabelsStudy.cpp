#include "libperception/study/LabelsStudy.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <map>
#include <optional>

#include "libperception/core/Error.h"
#include "libperception/evaluation/Gnuplot.h"
#include "libperception/evaluation/PlotScript.h"

namespace perception {
namespace {

constexpr std::uint32_t kDamagePurpose = 0x1abe15;  // of the random numbers

// Boxes of one thing, the surest first.
using Thing = std::vector<std::size_t>;

std::vector<Thing> thingsOf(const std::vector<ObjectDetection>& boxes,
                            const std::vector<std::string>& labels, double distance) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (boxes[i].space_box && std::count(labels.begin(), labels.end(), boxes[i].label))
      order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return boxes[a].score > boxes[b].score; });
  std::vector<Thing> things;
  for (const std::size_t i : order) {
    const auto joins = [&](const Thing& thing) {
      const Vector3 d =
          boxes[i].space_box->bottom_centre - boxes[thing.front()].space_box->bottom_centre;
      return d.head<2>().norm() < distance &&
             std::none_of(thing.begin(), thing.end(),
                          [&](std::size_t j) { return boxes[j].label == boxes[i].label; });
    };
    const auto thing = std::find_if(things.begin(), things.end(), joins);
    thing != things.end() ? thing->push_back(i) : things.push_back({i});
  }
  return things;
}

std::string otherLabel(const std::string& label, const std::vector<std::string>& labels, Rng& rng) {
  std::vector<std::string> others;
  for (const auto& l : labels) {
    if (l != label) others.push_back(l);
  }
  return others.empty() ? label : others[rng.below(static_cast<std::uint32_t>(others.size()))];
}

// The ways to track.
struct Method {
  const char* name;
  bool per_class;
  bool takes_unlabelled;  // per class: boxes without a label go to every class's tracker
};
constexpr Method kJoint = {"joint", false, true};
constexpr Method kPerClass = {"tracker per class", true, false};
constexpr Method kPerClassAll = {"tracker per class, unlabelled to all", true, true};

struct Condition {
  LabelDamage damage;
  Method method;
  LabelScore score;  // over all logs

  std::string labels() const {
    if (damage.kind == LabelDamage::kNone) return "as they are";
    if (damage.kind == LabelDamage::kDropped && damage.probability >= 1) return "none, pooled";
    return fmt::format("{:.0f} % {}", 100 * damage.probability,
                       damage.kind == LabelDamage::kDropped ? "dropped" : "flipped");
  }
};

std::vector<Condition> conditionsOf(const LabelsParams& params) {
  std::vector<Condition> conditions;
  const auto add = [&](LabelDamage::Kind kind, double p) {
    conditions.push_back({{kind, p}, kJoint, {}});
    if (kind != LabelDamage::kDropped || p < 1) conditions.push_back({{kind, p}, kPerClass, {}});
    if (kind == LabelDamage::kDropped) conditions.push_back({{kind, p}, kPerClassAll, {}});
  };
  add(LabelDamage::kNone, 0);
  for (const double p : params.shares) add(LabelDamage::kDropped, p);
  add(LabelDamage::kDropped, 1);
  for (const double p : params.shares) add(LabelDamage::kFlipped, p);
  return conditions;
}

// What all runs of one log share.
struct LogFacts {
  bool simulated = false;
  GroundTruth truth;              // objects of classes without a label are ignored
  std::vector<ClassId> classes;   // by label
  std::vector<bool> road_user;    // by class
  std::vector<int> measurements;  // by sample: the how-manieth of its object
};

// The measurements of a log as if each were an object put out: what the truth could be seen of.
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

LogFacts factsOf(const LabelledLog& log, const LabelsParams& params) {
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

void add(const ClearFigures& part, ClearFigures& sum) {
  sum.truth += part.truth;
  sum.misses += part.misses;
  sum.false_objects += part.false_objects;
  sum.id_switches += part.id_switches;
  sum.setMota();
}

ClearFigures sumOf(const std::vector<ClearFigures>& parts) {
  ClearFigures sum;
  for (const ClearFigures& p : parts) add(p, sum);
  return sum;
}

void add(const LabelScore& part, LabelScore& sum) {
  if (sum.of_class.empty()) {
    sum = part;
    return;
  }
  add(part.any_class, sum.any_class);
  for (std::size_t l = 0; l < part.of_class.size(); ++l) {
    add(part.of_class[l], sum.of_class[l]);
    for (std::size_t k = 0; k < part.objects[l].size(); ++k) {
      sum.objects[l][k] += part.objects[l][k];
      sum.right[l][k] += part.right[l][k];
    }
  }
}

// One log, spoilt and tracked in one way.
TrackedRun track(const LabelledLog& log, std::size_t number, const LogFacts& facts,
                 const Condition& condition, const LabelsParams& params) {
  const auto run = [&](const std::string& label, ClassId forced) {
    const RecordedLog recorded = log.record([&](ObjectDetections& detections, Stamp stamp) {
      const RngKey key = {params.seed, static_cast<std::uint64_t>(stamp.ns),
                          static_cast<std::uint32_t>(number), kDamagePurpose};
      damageLabels(condition.damage, params.labels, params.group_distance, key, detections);
      if (!label.empty()) keepLabel(label, condition.method.takes_unlabelled, detections);
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

// Share of the objects with a k-th measurement that then have an output of the right class.
std::optional<double> rightShare(const LabelScore& score, std::size_t k, int label = -1) {
  std::size_t objects = 0, right = 0;
  for (std::size_t l = 0; l < score.objects.size(); ++l) {
    if (label >= 0 && l != static_cast<std::size_t>(label)) continue;
    objects += score.objects[l][k - 1];
    right += score.right[l][k - 1];
  }
  if (objects == 0) return {};
  return static_cast<double>(right) / static_cast<double>(objects);
}

std::string percent(const std::optional<double>& value) {
  return value ? fmt::format("{:.1f}", 100 * *value) : "n/a";
}

StudyTable figuresTable(const std::vector<Condition>& conditions, const LabelsParams& params) {
  StudyTable table;
  table.name = "labels";
  table.title = "Tracking by what the detector says of the class";
  table.columns = {"labels",
                   "method",
                   "MOTA by class (%)",
                   "missed",
                   "false",
                   "id switches",
                   "MOTA, whatever class (%)",
                   "id switches, whatever class",
                   "right class after 1 (%)",
                   "after 3 (%)",
                   "after 10 (%)",
                   "after 30 (%)"};
  for (const Condition& c : conditions) {
    const ClearFigures by_class = sumOf(c.score.of_class);
    std::vector<std::string> row = {c.labels(),
                                    c.method.name,
                                    percent(by_class.mota),
                                    fmt::format("{}", by_class.misses),
                                    fmt::format("{}", by_class.false_objects),
                                    fmt::format("{}", by_class.id_switches),
                                    percent(c.score.any_class.mota),
                                    fmt::format("{}", c.score.any_class.id_switches)};
    for (const int k : {1, 3, 10, 30}) {
      row.push_back(k <= params.last_measurement
                        ? percent(rightShare(c.score, static_cast<std::size_t>(k)))
                        : "n/a");
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

StudyTable classTable(const std::vector<Condition>& conditions, const LabelsParams& params) {
  StudyTable table;
  table.name = "labels_by_class";
  table.title = "The same by class";
  table.columns = {"labels", "method"};
  for (const std::string& label : params.labels) {
    for (const char* figure : {"MOTA (%)", "id switches", "right after 10 (%)"})
      table.columns.push_back(label + ": " + figure);
  }
  for (const Condition& c : conditions) {
    std::vector<std::string> row = {c.labels(), c.method.name};
    for (std::size_t l = 0; l < params.labels.size(); ++l) {
      row.push_back(percent(c.score.of_class[l].mota));
      row.push_back(fmt::format("{}", c.score.of_class[l].id_switches));
      row.push_back(params.last_measurement >= 10
                        ? percent(rightShare(c.score, 10, static_cast<int>(l)))
                        : "n/a");
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

StudyTable curveTable(const std::vector<Condition>& conditions, const LabelsParams& params) {
  StudyTable table;
  table.name = "right_class";
  table.title =
      "Share of objects (%) that have an output of the right class at their k-th measurement";
  table.columns = {"labels", "method"};
  std::vector<std::size_t> numbers;
  for (const std::size_t k : {1, 2, 3, 4, 5, 7, 10, 15, 20, 30, 40}) {
    if (k <= static_cast<std::size_t>(params.last_measurement)) numbers.push_back(k);
  }
  for (const std::size_t k : numbers) table.columns.push_back(fmt::format("{}", k));
  std::vector<std::string> counts = {"(objects that had one)", ""};
  for (const std::size_t k : numbers) {
    std::size_t n = 0;
    for (const auto& objects : conditions.front().score.objects) n += objects[k - 1];
    counts.push_back(fmt::format("{}", n));
  }
  table.rows.push_back(std::move(counts));
  for (const Condition& c : conditions) {
    std::vector<std::string> row = {c.labels(), c.method.name};
    for (const std::size_t k : numbers) row.push_back(percent(rightShare(c.score, k)));
    table.rows.push_back(std::move(row));
  }
  return table;
}

// What a line of the pictures is of, and how it looks.
struct Line {
  Method method;
  const char* file;
  const char* title;
  std::string style;
};

std::vector<Line> lines() {
  return {{kJoint, "joint", "joint", fmt::format("lw 2 pt 7 lc rgb '{}'", plot_colour::kBlue)},
          {kPerClass, "per_class", "per class",
           fmt::format("lw 2 pt 5 lc rgb '{}'", plot_colour::kRed)},
          {kPerClassAll, "per_class_all", "unlabelled to all",
           fmt::format("lw 2 pt 9 lc rgb '{}'", plot_colour::kOrange)}};
}

// The points of one line over the share of spoilt labels: share, MOTA by class, MOTA and id
// switches whatever class, right after 10.
std::string pointsOf(const std::vector<Condition>& conditions, LabelDamage::Kind kind,
                     const Method& method) {
  std::string text;
  for (const Condition& c : conditions) {
    const bool none = c.damage.kind == LabelDamage::kNone;
    const bool same = std::string(c.method.name) == method.name ||
                      (none && c.method.per_class && method.per_class);
    if (!same || !(none || c.damage.kind == kind)) continue;
    const ClearFigures by_class = sumOf(c.score.of_class);
    const std::size_t k = std::min<std::size_t>(10, c.score.objects.front().size());
    // Pooled without labels stands behind a gap: 100 %, drawn at 70.
    text += fmt::format("{:.0f} {} {} {} {}\n",
                        c.damage.probability >= 1 ? 70 : 100 * c.damage.probability,
                        percent(by_class.mota), percent(c.score.any_class.mota),
                        c.score.any_class.id_switches, percent(rightShare(c.score, k)));
  }
  return text;
}

// A row of the picture: one figure, a column of the points.
struct Panel {
  const char* label;
  const char* range;
  int column;
};
constexpr Panel kPanels[] = {{"MOTA by class (%)", "[*:100]", 2},
                             {"MOTA, whatever class (%)", "[*:100]", 3},
                             {"identity switches", "[0:*]", 4},
                             {"right class after 10 (%)", "[0:100]", 5}};

StudyPlot figuresPlot(const std::vector<Condition>& conditions, const std::string& where) {
  StudyPlot plot;
  plot.name = "labels";
  plot.width = 1100, plot.height = 1200;
  plot.caption =
      "Joint classification beside a tracker per class, over the share of labels that were dropped "
      "(left) or flipped (right): MOTA by class and whatever the class, identity switches whatever "
      "the class, and objects with an output of the right class at their tenth measurement.";
  plot.script = fmt::format(
      "set multiplot layout 4,2 title {} noenhanced\nset grid\nset datafile missing 'n/a'\n"
      "set lmargin 10\nset key outside top center horizontal font ',9' samplen 2\n",
      gnuplotString("What labels are worth, " + where));
  for (const Panel& panel : kPanels) {
    for (const auto kind : {LabelDamage::kDropped, LabelDamage::kFlipped}) {
      const bool dropped = kind == LabelDamage::kDropped;
      const char* how = dropped ? "dropped" : "flipped";
      plot.script += fmt::format(
          "set key width {}\nset xlabel 'labels {} (%)'\nset ylabel '{}'\nset yrange {}\n"
          "set xrange [-2:{}]\n"
          "set xtics ({}'0' 0, '10' 10, '20' 20, '30' 30, '40' 40, '50' 50)\nplot ",
          dropped ? -4 : 0, how, panel.label, panel.range, dropped ? 75 : 52,
          dropped ? "'none left' 70, " : "");
      bool first = true;
      for (const Line& line : lines()) {
        if (!dropped && line.method.takes_unlabelled && line.method.per_class) continue;
        const std::string file = fmt::format("labels_{}_{}.dat", how, line.file);
        if (panel.column == 2) plot.data.push_back({file, pointsOf(conditions, kind, line.method)});
        plot.script += fmt::format(
            "{}'{}' using 1:{} with linespoints {} {}", first ? "" : ", ", file, panel.column,
            line.style,
            panel.column == 2 ? fmt::format("title '{}'", line.title) : std::string("notitle"));
        first = false;
      }
      plot.script += '\n';
    }
  }
  plot.script += "unset multiplot\n";
  return plot;
}

StudyPlot curvePlot(const std::vector<Condition>& conditions, const LabelsParams& params,
                    const std::string& where) {
  StudyPlot plot;
  plot.name = "right_class";
  plot.width = 1100, plot.height = 550;
  plot.caption =
      "Share of objects that have an output of the right class at their k-th measurement; full "
      "lines: joint classification, dashes: a tracker per class (unlabelled boxes left out).";
  plot.script = fmt::format(
      "set multiplot layout 1,2 title {} noenhanced\nset grid\nset key bottom right\n"
      "set datafile missing 'n/a'\nset xlabel 'measurements of the object'\n"
      "set ylabel 'output of the right class (%)'\nset xrange [0:{}]\nset yrange [0:100]\n",
      gnuplotString("Class by number of measurements, " + where), params.last_measurement + 1);
  for (const auto kind : {LabelDamage::kDropped, LabelDamage::kFlipped}) {
    plot.script += fmt::format("set title 'labels {}'\nplot ",
                               kind == LabelDamage::kDropped ? "dropped" : "flipped");
    bool first = true;
    std::map<std::string, std::size_t> colour;
    for (std::size_t i = 0; i < conditions.size(); ++i) {
      const Condition& c = conditions[i];
      const double p = c.damage.probability;
      const bool shown = p == 0 || p >= 1 || p == params.shares.back() ||
                         p == params.shares[params.shares.size() / 2];
      if (!shown || (c.damage.kind != kind && c.damage.kind != LabelDamage::kNone)) continue;
      if (c.method.per_class && c.method.takes_unlabelled) continue;
      const std::string file = fmt::format("right_class_{}.dat", i);
      std::string data;
      for (std::size_t k = 1; k <= static_cast<std::size_t>(params.last_measurement); ++k)
        data += fmt::format("{} {}\n", k, percent(rightShare(c.score, k)));
      if (plot.data.end() == std::find_if(plot.data.begin(), plot.data.end(),
                                          [&](const auto& d) { return d.first == file; }))
        plot.data.push_back({file, data});
      const std::size_t hue = colour.try_emplace(c.labels(), colour.size()).first->second;
      plot.script +=
          fmt::format("{}'{}' with lines lw 2 dt {} lc rgb '{}' title {} noenhanced",
                      first ? "" : ", ", file, c.method.per_class ? 2 : 1, plot_colour::ofRun(hue),
                      gnuplotString(c.labels() + ", " + c.method.name));
      first = false;
    }
    plot.script += '\n';
  }
  plot.script += "unset multiplot\n";
  return plot;
}

}  // namespace

void damageLabels(const LabelDamage& damage, const std::vector<std::string>& labels,
                  double group_distance, const RngKey& key, ObjectDetections& detections) {
  if (damage.kind == LabelDamage::kNone) return;
  std::vector<bool> gone(detections.objects.size(), false);
  Rng rng(key);
  for (const Thing& thing : thingsOf(detections.objects, labels, group_distance)) {
    // Drawn for every thing, hit or not: the draws of one do not depend on another's.
    const double u = rng.uniform();
    const std::string& label = detections.objects[thing.front()].label;
    const std::string other = otherLabel(label, labels, rng);
    if (u >= damage.probability) continue;
    for (std::size_t i = 1; i < thing.size(); ++i) gone[thing[i]] = true;
    detections.objects[thing.front()].label =
        damage.kind == LabelDamage::kDropped ? kNoLabel : other;
  }
  std::vector<ObjectDetection> kept;
  for (std::size_t i = 0; i < gone.size(); ++i) {
    if (!gone[i]) kept.push_back(std::move(detections.objects[i]));
  }
  detections.objects = std::move(kept);
}

void keepLabel(const std::string& label, bool without_label, ObjectDetections& detections) {
  auto& boxes = detections.objects;
  boxes.erase(std::remove_if(boxes.begin(), boxes.end(),
                             [&](const ObjectDetection& o) {
                               return o.label != label && !(without_label && o.label == kNoLabel);
                             }),
              boxes.end());
}

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
  options.exclusion =
      options.tolerance;  // CLEAR: an output is paired, on what is ignored, or false
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

StudyReport labelsStudy(const LabelsParams& params, const std::vector<LabelledLog>& logs) {
  std::vector<LogFacts> facts(logs.size());
  tbb::parallel_for(std::size_t{0}, logs.size(),
                    [&](std::size_t i) { facts[i] = factsOf(logs[i], params); });
  std::vector<Condition> conditions = conditionsOf(params);
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
  report.tables = {figuresTable(conditions, params), classTable(conditions, params),
                   curveTable(conditions, params)};
  report.plots = {figuresPlot(conditions, where), curvePlot(conditions, params, where)};
  report.remarks = {
      fmt::format("Labels are spoilt per thing and frame, independently: boxes of different labels "
                  "within {:g} m are of one thing, and one that is hit keeps its surest box with "
                  "place, size and score. Dropped: the box says '{}'; flipped: one of the other "
                  "labels, each alike. Real detectors err alike for seconds: these figures are the "
                  "kind side of the question.",
                  params.group_distance, kNoLabel),
      "Tracker per class: the same pipeline and motion models once per label, on that label's "
      "boxes "
      "only, outputs joined, each of its tracker's class. Boxes without a label are left out, or "
      "given to every tracker (unlabelled to all).",
      fmt::format("Put out is what exists and is a road user with a probability of {:g} or more. "
                  "Matching one-to-one within {:g} m on the ground; truth within {:g} m and {:g} "
                  "deg; outputs on truth that does not count are neither right nor wrong. KITTI's "
                  "DontCare areas have no place on the ground: outputs there count as false, for "
                  "all methods alike.",
                  params.least_output, params.evaluation.tolerance,
                  params.evaluation.selection.range, degrees(params.evaluation.selection.fov)),
      "MOTA by class: outputs of a class against objects of that class, errors summed over the "
      "classes (a wrong class is a miss and a false object). Whatever class: one output an object; "
      "a second one is false.",
      "k-th measurement: the k-th frame in which some box, of whatever label and score, lies on "
      "the object before labels are spoilt; the same instants for all methods. An object without "
      "an output has no right class."};
  return report;
}

}  // namespace perception
