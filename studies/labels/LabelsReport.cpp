#include "studies/labels/LabelsReport.h"

#include <fmt/format.h>

#include <functional>

#include "studies/labels/LabelsPlots.h"

namespace perception {
namespace {

using Row = std::vector<std::string>;

// A table with one row per condition: labels, method and the columns of `fill`.
StudyTable conditionsTable(const char* name, const char* title, const Row& figures,
                           const std::vector<LabelCondition>& conditions,
                           const std::function<void(const LabelCondition&, Row&)>& fill) {
  StudyTable table;
  table.name = name;
  table.title = title;
  table.columns = {"labels", "method"};
  table.columns.insert(table.columns.end(), figures.begin(), figures.end());
  for (const LabelCondition& c : conditions) {
    Row row = {c.labels(), c.method.name};
    fill(c, row);
    table.rows.push_back(std::move(row));
  }
  return table;
}

StudyTable figuresTable(const std::vector<LabelCondition>& conditions, const LabelsParams& params) {
  const Row figures = {"MOTA by class (%)",
                       "missed",
                       "false",
                       "id switches",
                       "MOTA, whatever class (%)",
                       "id switches, whatever class",
                       "right class after 1 (%)",
                       "after 3 (%)",
                       "after 10 (%)",
                       "after 30 (%)"};
  return conditionsTable(
      "labels", "Tracking by what the detector says of the class", figures, conditions,
      [&](const LabelCondition& c, Row& row) {
        const ClearFigures by_class = sumOf(c.score.of_class);
        row.push_back(percent(by_class.mota));
        for (const auto count : {by_class.misses, by_class.false_objects, by_class.id_switches})
          row.push_back(fmt::format("{}", count));
        row.push_back(percent(c.score.any_class.mota));
        row.push_back(fmt::format("{}", c.score.any_class.id_switches));
        for (const int k : {1, 3, 10, 30}) {
          row.push_back(k <= params.last_measurement
                            ? percent(rightShare(c.score, static_cast<std::size_t>(k)))
                            : "n/a");
        }
      });
}

StudyTable classTable(const std::vector<LabelCondition>& conditions, const LabelsParams& params) {
  Row figures;
  for (const std::string& label : params.labels) {
    for (const char* figure : {"MOTA (%)", "id switches", "right after 10 (%)"})
      figures.push_back(label + ": " + figure);
  }
  return conditionsTable(
      "labels_by_class", "The same by class", figures, conditions,
      [&](const LabelCondition& c, Row& row) {
        for (std::size_t l = 0; l < params.labels.size(); ++l) {
          row.push_back(percent(c.score.of_class[l].mota));
          row.push_back(fmt::format("{}", c.score.of_class[l].id_switches));
          row.push_back(params.last_measurement >= 10
                            ? percent(rightShare(c.score, 10, static_cast<int>(l)))
                            : "n/a");
        }
      });
}

StudyTable curveTable(const std::vector<LabelCondition>& conditions, const LabelsParams& params) {
  Row figures, counts = {"(objects that had one)", ""};
  std::vector<std::size_t> numbers;
  for (const std::size_t k : {1, 2, 3, 4, 5, 7, 10, 15, 20, 30, 40}) {
    if (k > static_cast<std::size_t>(params.last_measurement)) continue;
    numbers.push_back(k);
    figures.push_back(fmt::format("{}", k));
    std::size_t n = 0;
    for (const auto& objects : conditions.front().score.objects) n += objects[k - 1];
    counts.push_back(fmt::format("{}", n));
  }
  StudyTable table = conditionsTable(
      "right_class",
      "Share of objects (%) that have an output of the right class at their k-th measurement",
      figures, conditions, [&](const LabelCondition& c, Row& row) {
        for (const std::size_t k : numbers) row.push_back(percent(rightShare(c.score, k)));
      });
  table.rows.insert(table.rows.begin(), std::move(counts));
  return table;
}

}  // namespace

std::string LabelCondition::labels() const {
  if (damage.kind == LabelNoise::kNone) return "as they are";
  if (damage.kind == LabelNoise::kDropped && damage.probability >= 1) return "none, pooled";
  return fmt::format("{:.0f} % {}", 100 * damage.probability,
                     damage.kind == LabelNoise::kDropped ? "dropped" : "flipped");
}

void addClear(const ClearFigures& part, ClearFigures& sum) {
  sum.truth += part.truth;
  sum.misses += part.misses;
  sum.false_objects += part.false_objects;
  sum.id_switches += part.id_switches;
  sum.setMota();
}

ClearFigures sumOf(const std::vector<ClearFigures>& parts) {
  ClearFigures sum;
  for (const ClearFigures& p : parts) addClear(p, sum);
  return sum;
}

std::optional<double> rightShare(const LabelScore& score, std::size_t k, int label) {
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

void describeLabels(const LabelsParams& params, const std::vector<LabelCondition>& conditions,
                    const std::string& where, StudyReport& report) {
  report.tables = {figuresTable(conditions, params), classTable(conditions, params),
                   curveTable(conditions, params)};
  report.plots = {figuresPlot(conditions, where), curvePlot(conditions, params, where)};
  report.remarks = {
      fmt::format(
          "Labels are corrupted per thing and frame, independently: boxes of different labels "
          "within {:g} m are of one thing, and one that is hit keeps its surest box with "
          "place, size and score. Dropped: the box says '{}'; flipped: one of the other "
          "labels, each alike. Real detectors err alike for seconds: these figures are the "
          "kind side of the question.",
          params.group_distance, kNoLabel),
      "Tracker per class: the same pipeline and motion models once per label, on that label's "
      "boxes only, outputs joined, each of its tracker's class. Boxes without a label are left "
      "out, or given to every tracker (unlabeled to all).",
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
      "the object before labels are corrupted; the same instants for all methods. An object "
      "without an output has no right class."};
}

}  // namespace perception
