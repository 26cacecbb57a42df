#include <nlohmann/json.hpp>

#include "libperception/evaluation/front_ends/FrontEndJson.h"
#include "libperception/evaluation/tables/ReportCells.h"
#include "libperception/scene/files/RunMark.h"

namespace perception {
namespace {

using Json = nlohmann::ordered_json;

Json json(const Figure& figure) { return figure ? Json(*figure) : Json(nullptr); }

Json json(const TrackingFigures& f) {
  return {{"object_tracked_a", json(f.tracked_a)},
          {"object_tracked_b", json(f.tracked_b)},
          {"object_tracked_c", json(f.tracked_c)},
          {"range_rms_m", json(f.range_rms)},
          {"bearing_rms_rad", json(f.bearing_rms)},
          {"correct", json(f.correct)},
          {"mis", json(f.mis)},
          {"unclassified", json(f.unclassified)},
          {"returns", f.active ? Json(f.returns) : Json(nullptr)},
          {"active", f.active},
          {"active_in_sensor_range", f.in_sensor_range},
          {"active_first_to_last_tracked", f.first_to_last},
          {"centre_range_rms_m", json(f.center_range_rms)},
          {"position_rms_m", json(f.position_rms)},
          {"speed_rms_mps", json(f.speed_rms)},
          {"velocity_rms_mps", json(f.velocity_rms)},
          {"heading_rms_rad", json(f.heading_rms)},
          {"heading_reversed", json(f.heading_reversed)},
          {"heading_front_known", json(f.heading_sure)},
          {"heading_front_known_reversed", json(f.heading_sure_reversed)},
          {"id_switches", f.first_to_last ? Json(f.id_switches) : Json(nullptr)},
          {"fragmentations", f.first_to_last ? Json(f.fragmentations) : Json(nullptr)}};
}

Json json(const ObjectTimeline& o) {
  return {{"id", o.id},
          {"type", o.type},
          {"first_active_s", o.first_active},
          {"last_active_s", o.last_active},
          {"active", o.active},
          {"returns", o.returns},
          {"tracked", json(o.tracked)},
          {"first_tracked_s", json(o.first_tracked)},
          {"time_to_first_track_s", json(o.time_to_first_track)},
          {"ids", o.ids},
          {"id_switches", o.returns ? Json(o.id_switches) : Json(nullptr)},
          {"fragmentations", o.returns ? Json(o.fragmentations) : Json(nullptr)}};
}

Json json(const FalseObjectFigures& f) {
  const auto count = [&](std::size_t n) { return f.instants ? Json(n) : Json(nullptr); };
  return {{"per_instant", json(f.per_instant)},
          {"share", json(f.share)},
          {"false", count(f.counts.false_)},
          {"outputs", count(f.counts.named)},
          {"classified_per_instant", json(f.classified_per_instant)},
          {"classified_share", json(f.classified_share)},
          {"classified_false", count(f.counts.classified_false)},
          {"classified_outputs", count(f.counts.classified_named)}};
}

Json json(const BenchmarkFigures& f) {
  return {{"class", f.name},       {"truth", f.truth},   {"amota", f.amota},
          {"amotp_m", f.amotp},    {"recall", f.recall}, {"switches", f.switches},
          {"false", f.false_boxes}};
}

Json json(const SetFigures& f) {
  return {{"gospa_mean_m", json(f.gospa_mean)},
          {"gospa_rms_m", json(f.gospa_rms)},
          {"localisation_m2", json(f.localization)},
          {"missed_m2", json(f.missed)},
          {"false_m2", json(f.false_)},
          {"missed_objects", json(f.missed_objects)},
          {"false_objects", json(f.false_objects)},
          {"pair_rms_m", json(f.localization_rms)},
          {"ospa_mean_m", json(f.ospa_mean)},
          {"instants", f.instants}};
}

Json json(const Confusion& confusion, const std::vector<std::string>& class_names) {
  Json rows = Json::object();
  for (const auto& [type, row] : confusion.by_type) {
    Json cells = Json::object();
    for (std::size_t c = 0; c < class_names.size(); ++c) cells[class_names[c]] = row.classified[c];
    cells["unclassified"] = row.unclassified;
    cells["missed"] = row.missed;
    rows[type] = cells;
  }
  return rows;
}

Json json(const Reliability& reliability) {
  Json bins = Json::array();
  for (const ReliabilityBin& bin : reliability.bins) {
    bins.push_back({{"low", bin.low},
                    {"high", bin.high},
                    {"instants", bin.count},
                    {"mean_probability", json(bin.mean_probability)},
                    {"correct", json(bin.correct)}});
  }
  return {{"calibration_error", json(reliability.calibration_error)}, {"bins", bins}};
}

/// As runMark() does, so that whoever looks for marks finds it.
Json idJson(const EvaluatedRun& run) {
  return run.id.empty() ? Json(nullptr) : Json(runMark({run.id}));
}

Json trialJson(const EvaluatedRun& trial, double cutoff) {
  return {{"name", trial.name},
          {"dir", trial.dir},
          {"run", idJson(trial)},
          {"closest", json(trackingFigures(trial.evaluation, Pairing::kClosest))},
          {"one_to_one", json(trackingFigures(trial.evaluation, Pairing::kOneToOne))},
          {"false_objects", json(falseObjectFigures(trial.evaluation))},
          {"set_distance", json(setFigures(trial.evaluation, cutoff))}};
}

Json paperJson(const std::vector<PaperTrackingRow>& rows) {
  Json result = Json::array();
  for (const PaperTrackingRow& row : rows) {
    result.push_back({{"table", row.table},
                      {"condition", row.condition},
                      {"sensors", row.sensors},
                      {"object_tracked", row.tracked},
                      {"range_rms_m", row.range},
                      {"bearing_rms_rad", row.bearing},
                      {"correct", row.correct},
                      {"mis", row.mis},
                      {"returns", row.returns}});
  }
  return result;
}

Json pairingJson(const Evaluation& evaluation, Pairing pairing) {
  Json result;
  result["all"] = json(trackingFigures(evaluation, pairing));
  Json& classes = result["classes"] = Json::object();
  for (std::size_t c = 0; c < evaluation.class_names.size(); ++c) {
    if (!evaluation.named[c]) continue;
    classes[evaluation.class_names[c]] =
        json(trackingFigures(evaluation, pairing, static_cast<ClassId>(c)));
  }
  result["confusion"] = json(confusion(evaluation, pairing), evaluation.class_names);
  result["reliability"] = json(reliability(evaluation, pairing));
  Json& objects = result["truth_objects"] = Json::array();
  for (const ObjectTimeline& line : objectTimelines(evaluation, pairing))
    objects.push_back(json(line));
  return result;
}

Json frontsJson(const Evaluation& evaluation) {
  Json rows = Json::array();
  for (const auto& [class_id, motion, f] : frontRows(evaluation)) {
    rows.push_back({{"class", className(evaluation, class_id)},
                    {"motion", motion},
                    {"matched", f.matched},
                    {"with_heading", json(f.with_heading)},
                    {"front_known", json(f.front_known)},
                    {"known_reversed", json(f.known_reversed)},
                    {"other_reversed", json(f.other_reversed)},
                    {"calibration_error", json(f.calibration_error)}});
  }
  return rows;
}

Json falseObjectsJson(const Evaluation& evaluation) {
  Json result = {{"all", json(falseObjectFigures(evaluation))}, {"classes", Json::object()}};
  for (std::size_t c = 0; c < evaluation.class_names.size(); ++c) {
    if (!evaluation.named[c]) continue;
    result["classes"][evaluation.class_names[c]] =
        json(falseObjectFigures(evaluation, static_cast<ClassId>(c)));
  }
  return result;
}

Json instantsJson(const Evaluation& evaluation) {
  Json rows = Json::array();
  for (const InstantFigures& i : evaluation.instants) {
    const OutputCounts outputs = i.allOutputs();
    rows.push_back({{"frame", i.frame},
                    {"t", i.t},
                    {"truth", i.truth},
                    {"estimates", i.estimates},
                    {"gospa_m", i.gospa.value()},
                    {"localisation_m2", i.gospa.localization},
                    {"missed_m2", i.gospa.missed},
                    {"false_m2", i.gospa.false_},
                    {"ospa_m", i.ospa},
                    {"outputs", outputs.named},
                    {"false", outputs.false_}});
  }
  return rows;
}

Json coverageJson(const Evaluation& evaluation) {
  const TruthAlignment& a = evaluation.alignment;
  Json uses = Json::object();
  for (int use = 0; use < kTruthUses; ++use) {
    uses[describe(static_cast<TruthUse>(use))] =
        evaluation.truth_use[static_cast<std::size_t>(use)];
  }
  return {{"scenes_by_frame", a.by_frame},
          {"scenes_by_time", a.by_time},
          {"scenes_assumed_empty", a.assumed_empty},
          {"scenes_without_truth", a.scenes_without_truth},
          {"truth_instants_without_scene", a.truth_without_scene},
          {"truth_lines", uses}};
}

Json identitiesJson(const Evaluation& e) {
  const IdentityFigures f = identityFigures(e);
  return {{"mota", json(clearFigures(e).mota)},
          {"hota", json(f.hota)},
          {"det_a", json(f.detection)},
          {"ass_a", json(f.association)},
          {"idf1", json(f.idf1)}};
}

Json optionsJson(const EvaluationOptions& o) {
  return {{"range_m", o.selection.range},
          {"fov_deg", degrees(o.selection.fov)},
          {"complete_fov_deg", degrees(o.selection.complete_fov)},
          {"min_points", o.selection.min_points},
          {"max_occluded", o.selection.max_occluded},
          {"tolerance_m", o.tolerance},
          {"exclusion_m", o.exclusion},
          {"cutoff_m", o.cutoff},
          {"time_limit_s", o.alignment.time_limit},
          {"empty_frames", o.alignment.empty_frames},
          {"min_existence", o.min_existence},
          {"unnamed", o.unnamed}};
}

}  // namespace

std::string jsonReport(const EvaluationReport& report) {
  Json result = {{"command", report.command},
                 {"truth", report.truth},
                 {"reference", report.reference.empty() ? Json(nullptr) : Json(report.reference)},
                 {"options", optionsJson(report.options)},
                 {"runs", Json::array()}};
  for (const EvaluatedRun& run : report.runs) {
    const Evaluation& e = run.evaluation;
    Json entry = {{"name", run.name},
                  {"dir", run.dir},
                  {"run", idJson(run)},
                  {"sensors", e.sensors.empty() ? Json(nullptr) : Json(e.sensors)},
                  {"coverage", coverageJson(e)},
                  {"closest", pairingJson(e, Pairing::kClosest)},
                  {"one_to_one", pairingJson(e, Pairing::kOneToOne)},
                  {"false_objects", falseObjectsJson(e)},
                  {"set_distance", json(setFigures(e, report.options.cutoff))},
                  {"identities", identitiesJson(e)}};
    if (run.count_difference) {
      entry["count_rms"] = {{"all", json(run.count_difference->all)},
                            {"classified", json(run.count_difference->classified)},
                            {"instants", run.count_difference->instants}};
    }
    entry["fronts"] = frontsJson(e);
    entry["existence_reliability"] = json(existenceReliability(e));
    if (!run.benchmark.empty()) {
      Json& benchmark = entry["nuscenes_tracking"] = Json::array();
      for (const BenchmarkFigures& f : run.benchmark) benchmark.push_back(json(f));
    }
    if (!run.front_ends.empty()) {
      Json& front_ends = entry["front_ends"] = Json::array();
      for (const FrontEndEvaluation& f : run.front_ends) front_ends.push_back(frontEndJson(f));
    }
    if (run.trials.empty()) {
      entry["instants"] = instantsJson(e);
    } else {
      Json& trials = entry["trials"] = Json::array();
      for (const EvaluatedRun& t : run.trials)
        trials.push_back(trialJson(t, report.options.cutoff));
    }
    result["runs"].push_back(std::move(entry));
  }
  if (!report.paper.empty()) result["paper"] = paperJson(report.paper);
  // Paths need not be UTF-8.
  return result.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace perception
