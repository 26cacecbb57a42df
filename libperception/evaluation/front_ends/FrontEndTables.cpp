#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "libperception/evaluation/tables/ReportCells.h"
#include "libperception/scene/files/NumberFormat.h"

namespace perception {
namespace {

std::string percent(std::size_t part, std::size_t whole) {
  if (whole == 0) return kNotAvailable;
  return fixedPlaces(100 * static_cast<double>(part) / static_cast<double>(whole), 1) + " %";
}

std::string percent(const std::optional<double>& share) {
  return share ? fixedPlaces(100 * *share, 0) + " %" : "";
}

std::string count(std::size_t n) { return fmt::format("{}", n); }

// One front end of one run.
struct Named {
  std::string run;
  const FrontEndEvaluation* front_end;
};

std::vector<Named> allOf(const EvaluationReport& report) {
  std::vector<Named> all;
  for (const EvaluatedRun& run : report.runs) {
    for (const FrontEndEvaluation& f : run.front_ends) all.push_back({run.name, &f});
  }
  return all;
}

// Measurements of all labels of this size, of the labels of [radecki2016] or of all.
PrecisionCounts precisionOf(const FrontEndEvaluation& f, LabelMeaning::Size size, bool primary) {
  PrecisionCounts sum;
  for (const auto& entry : f.labels) {
    const LabelMeaning meaning = meaningOf(entry.first, f.class_names);
    if (meaning.size == size && (meaning.primary || !primary)) sum += f.precision(entry.first);
  }
  return sum;
}

bool speaksOfSize(const FrontEndEvaluation& f, LabelMeaning::Size size) {
  return f.surroundings && std::any_of(f.labels.begin(), f.labels.end(), [&](const auto& entry) {
           const LabelMeaning meaning = meaningOf(entry.first, f.class_names);
           return meaning.size == size && meaning.sized;
         });
}

bool hasFurtherLabels(const FrontEndEvaluation& f) {
  return std::any_of(f.labels.begin(), f.labels.end(), [&](const auto& entry) {
    return !meaningOf(entry.first, f.class_names).primary;
  });
}

Row summaryRow(const Named& named, bool primary) {
  const FrontEndEvaluation& f = *named.front_end;
  const bool two = hasFurtherLabels(f);
  Row row = {named.run, f.name + (!two      ? ""
                                  : primary ? ", labels of Radecki et al."
                                            : ", all labels")};
  for (const bool person : {false, true}) {
    const RecallCounts r =
        f.recall({person ? std::string("pedestrian") : std::string("car")}, true);
    const auto size = person ? LabelMeaning::Size::kPerson : LabelMeaning::Size::kVehicle;
    const PrecisionCounts p = precisionOf(f, size, primary);
    row.push_back(percent(r.found, r.in_view));
    row.push_back(percent(primary ? r.named_primary : r.named, r.in_view));
    row.push_back(speaksOfSize(f, size) ? percent(p.right_size, p.measurements) : kNotAvailable);
    row.push_back(percent(p.right_class, p.measurements));
  }
  return row;
}

ReportTable summaryTable(const std::vector<Named>& all, const EvaluationReport& report) {
  ReportTable table =
      makeTable("Recall and precision of front ends", {"Run", "Front end"},
                {"Car found", "Car recall", "Car-sized precision", "Car precision", "Person found",
                 "Person recall", "Person-sized precision", "Person precision"});
  table.notes = {
      fmt::format(
          "found: some measurement lies on the object; recall: one whose label names its class. Of "
          "cars (cars, vans), of persons (pedestrians) inside the sensor's view and its range for "
          "the class (where P_D is half of what it is near), occluded <= {}, lidar points >= {} "
          "where counted.",
          report.options.selection.max_occluded, report.options.selection.min_points),
      "precision: share of the measurements of such labels that lie on an object so named (car: "
      "any vehicle; person: pedestrian or cyclist); sized: on anything of that size, poles and "
      "hedges included.",
      "sized is n/a of cameras and where the truth does not hold what stands around (walls are in "
      "no truth: a measurement on one is wrong at both levels).",
      "Radecki et al.: sized precision as in their text; recall over the sensor's range."};
  for (const Named& named : all) {
    table.rows.push_back(summaryRow(named, true));
    if (hasFurtherLabels(*named.front_end)) table.rows.push_back(summaryRow(named, false));
  }
  for (const PaperFrontEndRow& p : paperFrontEndRows()) {
    if (!anyRunOfWeather(report, [&](auto& w) { return paperConditionHasWeather(p.condition, w); }))
      continue;
    table.rows.push_back({"Radecki et al.", fmt::format("{}, {}", p.sensor, p.condition), "",
                          percent(p.car_recall), percent(p.car_size_precision),
                          percent(p.car_precision), "", percent(p.person_recall),
                          percent(p.person_size_precision), percent(p.person_precision)});
  }
  return table;
}

Row recallRow(const RecallCounts& all, const RecallCounts& points) {
  const std::size_t on = all.found ? all.measurements : 0;
  return {count(all.in_view),
          percent(all.found, all.in_view),
          percent(all.named, all.in_view),
          count(points.in_view),
          percent(points.found, points.in_view),
          percent(points.named, points.in_view),
          all.found == 0
              ? kNotAvailable
              : fixedPlaces(static_cast<double>(on) / static_cast<double>(all.found), 2)};
}

ReportTable recallTable(const std::vector<Named>& all, const EvaluationReport& report) {
  ReportTable table = makeTable("Recall of front ends by class and range",
                                {"Run", "Front end", "Class", "Range (m)"},
                                {"in view", "found", "named", "with points", "found, with points",
                                 "named, with points", "measurements per found"});
  table.notes = {
      fmt::format("in view: objects times scans, in the sensor's view and range, occluded <= {}; "
                  "with points: of these with at least {} lidar points where counted.",
                  report.options.selection.max_occluded, report.options.selection.min_points),
      "measurements per found: above 1 where objects fall into parts."};
  for (const Named& named : all) {
    const FrontEndEvaluation& f = *named.front_end;
    for (std::size_t c = 0; c < f.class_names.size(); ++c) {
      const RecallCounts sum = f.recall({f.class_names[c]}, false);
      if (sum.in_view == 0) continue;
      const auto add = [&](const std::string& range, const RecallCounts& visible,
                           const RecallCounts& points) {
        Row row = {named.run, f.name, f.class_names[c], range};
        const Row figures = recallRow(visible, points);
        row.insert(row.end(), figures.begin(), figures.end());
        table.rows.push_back(std::move(row));
      };
      add("all", sum, f.recall({f.class_names[c]}, true));
      for (std::size_t b = 0; b < f.bins(); ++b) {
        if (f.visible[c][b].in_view == 0) continue;
        add(fmt::format("{:g}-{:g}", f.range_edges[b], f.range_edges[b + 1]), f.visible[c][b],
            f.with_points[c][b]);
      }
    }
  }
  return table;
}

ReportTable precisionTable(const std::vector<Named>& all) {
  ReportTable table = makeTable("Precision of front ends by label and range",
                                {"Run", "Front end", "Label", "Range (m)"},
                                {"measurements", "per scan", "right class", "right size"});
  table.notes = {"Of measurements where the truth knows all objects (--complete-fov-deg)."};
  for (const Named& named : all) {
    const FrontEndEvaluation& f = *named.front_end;
    for (const auto& entry : f.labels) {
      const std::string& label = entry.first;
      const auto& bins = entry.second;
      const auto add = [&](const std::string& range, const PrecisionCounts& p) {
        const double scans = std::max<double>(1, static_cast<double>(f.scans));
        table.rows.push_back({named.run, f.name, label, range, count(p.measurements),
                              fixedPlaces(static_cast<double>(p.measurements) / scans, 2),
                              percent(p.right_class, p.measurements),
                              f.surroundings && meaningOf(label, f.class_names).sized
                                  ? percent(p.right_size, p.measurements)
                                  : kNotAvailable});
      };
      add("all", f.precision(label));
      for (std::size_t b = 0; b < bins.size(); ++b) {
        if (bins[b].measurements == 0) continue;
        add(fmt::format("{:g}-{:g}", f.range_edges[b], f.range_edges[b + 1]), bins[b]);
      }
    }
  }
  return table;
}

ReportTable kindsTable(const std::vector<Named>& all) {
  std::set<std::string> kinds;
  for (const Named& named : all) {
    for (const auto& entry : named.front_end->labels) {
      for (const auto& [kind, n] : named.front_end->precision(entry.first).on) kinds.insert(kind);
    }
  }
  kinds.erase(kNothing);
  Row columns(kinds.begin(), kinds.end());
  columns.emplace_back(kNothing);
  ReportTable table =
      makeTable("What measurements of front ends lie on", {"Run", "Front end", "Label"}, columns);
  table.notes = {
      "Measurements, by the truth's type of the nearest thing that they lie on.",
      "nothing in the truth: walls, and whatever the truth does not hold (KITTI: everything that "
      "is no road user)."};
  for (const Named& named : all) {
    for (const auto& entry : named.front_end->labels) {
      const PrecisionCounts p = named.front_end->precision(entry.first);
      Row row = {named.run, named.front_end->name, entry.first};
      for (const std::string& kind : columns) {
        const auto found = p.on.find(kind);
        row.push_back(count(found == p.on.end() ? 0 : found->second));
      }
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

}  // namespace

std::vector<ReportTable> frontEndTables(const EvaluationReport& report) {
  const std::vector<Named> all = allOf(report);
  if (all.empty()) return {};
  return {summaryTable(all, report), recallTable(all, report), precisionTable(all),
          kindsTable(all)};
}

}  // namespace perception
