#include <fmt/format.h>

#include <algorithm>

#include "libperception/evaluation/tables/ReportCells.h"
#include "libperception/scene/files/NumberFormat.h"

namespace perception {
namespace {

bool hasTruth(const Evaluation& evaluation, ClassId c) {
  return std::any_of(evaluation.samples.begin(), evaluation.samples.end(),
                     [c](const TruthSample& s) { return s.class_id == c; });
}

// -1 (all), then every class that the counted truth has.
std::vector<ClassId> classesWithTruth(const Evaluation& evaluation) {
  std::vector<ClassId> classes = {-1};
  for (ClassId c = 0; c < static_cast<ClassId>(evaluation.class_names.size()); ++c) {
    if (hasTruth(evaluation, c)) classes.push_back(c);
  }
  return classes;
}

// [radecki2016]'s rows, in the columns of paperTable().
void addPaperRows(const EvaluationReport& report, ReportTable& table) {
  for (const PaperTrackingRow& row : report.paper) {
    table.rows.push_back({fmt::format("Radecki et al.: {}, {}", row.sensors, row.condition), "all",
                          fixedPlaces(row.tracked, 3), fixedPlaces(row.range, 3),
                          fixedPlaces(row.bearing, 3), fixedPlaces(row.correct, 3),
                          fixedPlaces(row.mis, 3), fmt::format("{}", row.returns)});
  }
}

ReportTable paperTable(const EvaluationReport& report) {
  ReportTable table =
      makeTable("Results, columns as in Radecki et al.", {"Run", "Class"},
                {"Object Tracked", "Range Error (m)", "Bearing Error (rad)",
                 "Correct Classification", "Mis-Classification", "Number of Returns"});
  table.notes = {
      fmt::format("Object Tracked: share of the instants of counted truth objects at which the "
                  "closest estimate has its center within {:g} m of the truth's; one estimate may "
                  "serve several truths.",
                  report.options.tolerance),
      "Range Error, Bearing Error: rms over the tracked instants, of the range to the closest "
      "point of the footprint and of "
      "the bearing of the center.",
      "Correct, Mis-Classification: share of the tracked instants at which a class has probability "
      ">= .95 and is right, wrong; the rest is unclassified.",
      "Number of Returns: number of tracked instants."};
  for (const EvaluatedRun& run : report.runs) {
    for (const ClassId c : classesWithTruth(run.evaluation)) {
      const TrackingFigures f = trackingFigures(run.evaluation, Pairing::kClosest, c);
      table.rows.push_back({run.name, className(run.evaluation, c), number(f.tracked_a),
                            number(f.range_rms), number(f.bearing_rms), number(f.correct),
                            number(f.mis), countOf(f.returns, f.active > 0)});
    }
  }
  addPaperRows(report, table);
  return table;
}

// A table with one row for each run, class and pairing.
template <class MakeRow>
void addPairedRows(const EvaluationReport& report, ReportTable& table, MakeRow makeRow) {
  for (const EvaluatedRun& run : report.runs) {
    for (const ClassId c : classesWithTruth(run.evaluation)) {
      for (const Pairing pairing : kAllPairings) {
        Row row = {run.name, className(run.evaluation, c), nameOf(pairing)};
        const Row figures = makeRow(trackingFigures(run.evaluation, pairing, c));
        row.insert(row.end(), figures.begin(), figures.end());
        table.rows.push_back(std::move(row));
      }
    }
  }
}

ReportTable trackedTable(const EvaluationReport& report) {
  ReportTable table = makeTable("Object tracked, three denominators", {"Run", "Class", "Matching"},
                                {"A", "B", "C", "active", "B active", "C active", "returns",
                                 "id switches", "fragmentations"});
  std::string sensors;
  for (const EvaluatedRun& run : report.runs) {
    sensors += fmt::format("{}{}", sensors.empty() ? "" : ", ",
                           run.evaluation.sensors.empty() ? kNotAvailable : run.evaluation.sensors);
  }
  table.notes = {
      "closest: as above. one-to-one: an estimate serves one truth; most pairs within the "
      "tolerance, then least total "
      "distance.",
      "A: over all active instants of counted truth objects, the first instants of the run "
      "included.",
      fmt::format("B: over those within the range of the sensor set: all with lidar, else 15 m, "
                  "persons 10 m (sensors: {}).",
                  sensors),
      "C: over those from each object's first to its last tracked instant.",
      "id switches: the estimate's id is another one than at the object's last tracked instant. "
      "fragmentations: gaps in tracking while active."};
  addPairedRows(report, table, [](const TrackingFigures& f) {
    const bool known = f.active > 0;
    return Row{number(f.tracked_a),
               number(f.tracked_b),
               number(f.tracked_c),
               countOf(f.active, known),
               countOf(f.in_sensor_range, known),
               countOf(f.first_to_last, known),
               countOf(f.returns, known),
               countOf(f.id_switches, f.first_to_last > 0),
               countOf(f.fragmentations, f.first_to_last > 0)};
  });
  return table;
}

ReportTable errorTable(const EvaluationReport& report) {
  ReportTable table =
      makeTable("Errors at tracked instants (rms)", {"Run", "Class", "Matching"},
                {"range (m)", "center range (m)", "bearing (rad)", "position (m)", "speed (m/s)",
                 "velocity (m/s)", "heading (rad)", "reversed", "front known", "known, reversed"});
  table.notes = {
      "range: to the closest point of the footprint; center range, bearing, position: of the "
      "center; on the ground plane.",
      "speed: of the magnitudes; velocity: of the vectors; where the truth has a velocity.",
      "heading: where truth and estimate have one; reversed: share of these more than 90 deg off.",
      "front known: share of the headings with p_front of at least 0.9; known, reversed: share of "
      "these more than 90 deg off."};
  addPairedRows(report, table, [](const TrackingFigures& f) {
    return Row{number(f.range_rms),    number(f.center_range_rms),
               number(f.bearing_rms),  number(f.position_rms),
               number(f.speed_rms),    number(f.velocity_rms),
               number(f.heading_rms),  number(f.heading_reversed),
               number(f.heading_sure), number(f.heading_sure_reversed)};
  });
  return table;
}

ReportTable classificationTable(const EvaluationReport& report) {
  ReportTable table = makeTable("Classification at tracked instants", {"Run", "Class", "Matching"},
                                {"correct", "mis", "unclassified"});
  table.notes = {"Shares of the tracked instants; they sum to 1. Van counts as car, Truck as bus."};
  addPairedRows(report, table, [](const TrackingFigures& f) {
    return Row{number(f.correct), number(f.mis), number(f.unclassified)};
  });
  return table;
}

ReportTable falseObjectTable(const EvaluationReport& report) {
  ReportTable table = makeTable(
      "False objects", {"Run", "Estimated class"},
      {"false per instant", "share of outputs", "false", "outputs", "classified per instant",
       "share of classified", "classified false", "classified outputs"});
  table.notes = {
      fmt::format("Output as a named class (most probable class; not {}) inside the sector, no "
                  "truth of any type within {:g} m of its center or under it, areas marked "
                  "DontCare with a place included.",
                  fmt::join(report.options.unnamed, ", "), report.options.exclusion),
      fmt::format(
          "Only within {:g} deg ahead: a truth that covers less (KITTI labels the camera's view, "
          "about 80 deg) needs --complete-fov-deg.",
          degrees(std::min(report.options.selection.fov, report.options.selection.complete_fov))),
      "An area without a place (KITTI's DontCare are areas of the image) excuses no output.",
      "classified: of these, the ones whose class has probability >= .95."};
  for (const EvaluatedRun& run : report.runs) {
    const Evaluation& evaluation = run.evaluation;
    for (ClassId c = -1; c < static_cast<ClassId>(evaluation.class_names.size()); ++c) {
      if (c >= 0 && !evaluation.named[static_cast<std::size_t>(c)]) continue;
      const FalseObjectFigures f = falseObjectFigures(evaluation, c);
      const bool known = f.instants > 0;
      table.rows.push_back({run.name, className(evaluation, c), number(f.per_instant),
                            number(f.share), countOf(f.counts.false_, known),
                            countOf(f.counts.named, known), number(f.classified_per_instant),
                            number(f.classified_share), countOf(f.counts.classified_false, known),
                            countOf(f.counts.classified_named, known)});
    }
  }
  return table;
}

ReportTable setTable(const EvaluationReport& report) {
  const double cutoff = report.options.cutoff;
  ReportTable table = makeTable(
      "Distance between the sets of objects", {"Run"},
      {"GOSPA mean (m)", "GOSPA rms (m)", "localization (m2)", "missed (m2)", "false (m2)",
       "missed objects", "false objects", "pair rms (m)", "OSPA mean (m)", "instants"});
  table.notes = {
      fmt::format(
          "GOSPA with c = {0:g} m, p = 2, alpha = 2; OSPA with c = {0:g} m, p = 2; of the centers.",
          cutoff),
      "localization + missed + false = (GOSPA rms)^2; missed, false objects: mean number an "
      "instant.",
      "Truth: the counted objects. Estimates: of named classes only, since the truth does not "
      "label poles: those that pair with a",
      "counted truth, and the others inside the sector unless a truth that does not count stands "
      "near (see False objects).",
      "Over the instants with a counted truth or such an estimate."};
  for (const EvaluatedRun& run : report.runs) {
    const SetFigures f = setFigures(run.evaluation, cutoff);
    table.rows.push_back(
        {run.name, number(f.gospa_mean), number(f.gospa_rms), number(f.localization),
         number(f.missed), number(f.false_), number(f.missed_objects), number(f.false_objects),
         number(f.localization_rms), number(f.ospa_mean), fmt::format("{}", f.instants)});
  }
  return table;
}

ReportTable countTable(const EvaluationReport& report) {
  ReportTable table =
      makeTable("Number of objects against the reference run", {"Run"},
                {"RMS Error: Number of Objects", "RMS Error: Num. Classified Objects", "instants"});
  table.notes = {"At the instants that both runs have; reference: " + report.reference};
  for (const EvaluatedRun& run : report.runs) {
    const CountDifference d = run.count_difference.value_or(CountDifference());
    table.rows.push_back(
        {run.name, number(d.all), number(d.classified), fmt::format("{}", d.instants)});
  }
  return table;
}

ReportTable coverageTable(const EvaluationReport& report) {
  ReportTable table = makeTable("What was compared", {"Run", ""}, {"count"});
  table.notes = {
      "A scene without truth, a truth without scene and a truth object that does not count are in "
      "no figure."};
  for (const EvaluatedRun& run : report.runs) {
    const TruthAlignment& a = run.evaluation.alignment;
    const auto add = [&](const std::string& what, std::size_t count) {
      table.rows.push_back({run.name, what, fmt::format("{}", count)});
    };
    add("scenes matched by frame number", a.by_frame);
    add("scenes matched by time", a.by_time);
    add("scenes without a truth line, taken as empty", a.assumed_empty);
    add("scenes without truth", a.scenes_without_truth);
    add("truth instants without scene", a.truth_without_scene);
    for (int use = 0; use < kTruthUses; ++use) {
      add(fmt::format("truth lines {}", describe(static_cast<TruthUse>(use))),
          run.evaluation.truth_use[static_cast<std::size_t>(use)]);
    }
  }
  return table;
}

// Of runs that were evaluated with --nuscenes; empty rows: of none.
ReportTable benchmarkTable(const EvaluationReport& report) {
  ReportTable table = makeTable("nuScenes' tracking benchmark", {"run", "class"},
                                {"truth", "AMOTA", "AMOTP [m]", "recall", "switches", "false"});
  table.notes = {
      "AMOTA: mean of MOTAR over 40 recalls from 0.1 to 1, AMOTP: of the error of centers; recalls "
      "that are not reached count 0 and 2 m. Matches within 2 m; ranges 50 m, two-wheelers and "
      "pedestrians 40 m. The score of a track is its existence.",
      "recall, switches, false: of all tracks. Bicycle racks are not known, and truth without "
      "lidar returns is left out, whether radar sees it or not: figures are not the server's."};
  for (const EvaluatedRun& run : report.runs) {
    double amota = 0, amotp = 0;
    for (const BenchmarkFigures& f : run.benchmark) {
      table.rows.push_back({run.name, f.name, fmt::format("{}", f.truth), number(f.amota),
                            number(f.amotp), number(f.recall), fmt::format("{}", f.switches),
                            fmt::format("{}", f.false_boxes)});
      amota += f.amota, amotp += f.amotp;
    }
    const auto classes = static_cast<double>(run.benchmark.size());
    if (run.benchmark.size() > 1)
      table.rows.push_back({run.name, "mean of the classes", "", number(amota / classes),
                            number(amotp / classes), "", "", ""});
  }
  return table;
}

}  // namespace

std::vector<ReportTable> reportTables(const EvaluationReport& report) {
  std::vector<ReportTable> tables = {paperTable(report)};
  if (report.runs.size() > 1) tables.push_back(sideBySideTable(report));
  for (const auto& table :
       {trackedTable(report), errorTable(report), frontTable(report), classificationTable(report),
        falseObjectTable(report), setTable(report)}) {
    tables.push_back(table);
  }
  for (ReportTable& table : frontEndTables(report)) tables.push_back(std::move(table));
  if (ReportTable table = benchmarkTable(report); !table.rows.empty())
    tables.push_back(std::move(table));
  if (!report.reference.empty()) tables.push_back(countTable(report));
  for (const EvaluatedRun& run : report.runs) {
    if (run.evaluation.samples.empty()) continue;
    for (const Pairing pairing : kAllPairings) tables.push_back(confusionTable(run, pairing));
    tables.push_back(reliabilityTable(run));
    if (!run.evaluation.existence.empty()) tables.push_back(existenceTable(run));
    if (!run.trials.empty()) continue;
    tables.push_back(objectTable(run));
    ReportTable worst = worstInstantsTable(run);
    if (!worst.rows.empty()) tables.push_back(std::move(worst));
  }
  tables.push_back(coverageTable(report));
  return tables;
}

}  // namespace perception
