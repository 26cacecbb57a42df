#include <fmt/format.h>

#include "libperception/evaluation/tables/ReportCells.h"
#include "libperception/scene/files/NumberFormat.h"

namespace perception {
namespace {

void addBins(const Reliability& r, ReportTable& table) {
  for (const ReliabilityBin& bin : r.bins) {
    table.rows.push_back({fmt::format("{:.1f}-{:.1f}", bin.low, bin.high),
                          fmt::format("{}", bin.count), number(bin.mean_probability),
                          number(bin.correct)});
  }
}

}  // namespace

ReportTable confusionTable(const EvaluatedRun& run, Pairing pairing) {
  std::vector<std::string> numbers = run.evaluation.class_names;
  numbers.insert(numbers.end(), {"unclassified", "missed"});
  ReportTable table = makeTable(
      fmt::format("Truth type against estimated class, {} matching: {}", nameOf(pairing), run.name),
      {"Truth type"}, numbers);
  table.notes = {
      "Instants. A class: probability >= .95; unclassified: tracked without; missed: not tracked."};
  for (const auto& [type, counts] : confusion(run.evaluation, pairing).by_type) {
    Row row = {type};
    for (const std::size_t n : counts.classified) row.push_back(fmt::format("{}", n));
    row.push_back(fmt::format("{}", counts.unclassified));
    row.push_back(fmt::format("{}", counts.missed));
    table.rows.push_back(std::move(row));
  }
  return table;
}

ReportTable reliabilityTable(const EvaluatedRun& run) {
  const Reliability r = reliability(run.evaluation, Pairing::kOneToOne);
  ReportTable table = makeTable("Reliability of the class probability: " + run.name,
                                {"probability"}, {"instants", "mean stated", "correct"});
  table.notes = {"One-to-one matched outputs by the probability of their most probable class.",
                 "mean |stated - correct|, weighted by instants: " + number(r.calibration_error)};
  addBins(r, table);
  return table;
}

ReportTable existenceTable(const EvaluatedRun& run) {
  const Reliability r = existenceReliability(run.evaluation);
  ReportTable table = makeTable("Reliability of the existence probability: " + run.name,
                                {"probability"}, {"outputs", "mean stated", "real"});
  table.notes = {
      "Outputs as a named class inside the sector. real: paired one-to-one with a truth of any "
      "type; an object output twice is real once.",
      "Where the truth holds no poles and hedges (KITTI), one that is called a road user is not "
      "real "
      "here, though something stands there.",
      "Outputs near a truth that they are not paired with are left out. A run writes objects from "
      "[scene] min_existence on: set it to 0 to see the whole range, and --min-existence 0.5 here.",
      "mean |stated - real|, weighted by outputs: " + number(r.calibration_error)};
  addBins(r, table);
  return table;
}

ReportTable objectTable(const EvaluatedRun& run) {
  ReportTable table = makeTable(
      "Truth objects: " + run.name, {"Id", "Type"},
      {"first active (s)", "last active (s)", "active", "tracked, closest", "tracked, one-to-one",
       "first tracked (s)", "time to first (s)", "id switches", "fragmentations", "ids used"});
  table.notes = {
      "active: instants at which the object counts; times: seconds since the log's first stamp.",
      "From 'first tracked' on: one-to-one matching."};
  const auto closest = objectTimelines(run.evaluation, Pairing::kClosest);
  const auto single = objectTimelines(run.evaluation, Pairing::kOneToOne);
  for (std::size_t i = 0; i < single.size(); ++i) {
    const ObjectTimeline& o = single[i];
    const bool tracked = o.returns > 0;
    table.rows.push_back({fmt::format("{}", o.id), o.type, fixedPlaces(o.first_active, 2),
                          fixedPlaces(o.last_active, 2), fmt::format("{}", o.active),
                          number(closest[i].tracked), number(o.tracked), number(o.first_tracked, 2),
                          number(o.time_to_first_track, 2), countOf(o.id_switches, tracked),
                          countOf(o.fragmentations, tracked),
                          tracked ? fmt::format("{}", fmt::join(o.ids, " ")) : kNotAvailable});
  }
  return table;
}

}  // namespace perception
