#include "libperception/evaluation/front_ends/FrontEndJson.h"

namespace perception {

using Json = nlohmann::ordered_json;

namespace {

Json countsJson(const RecallCounts& r) {
  return {{"in_view", r.in_view},
          {"found", r.found},
          {"named", r.named},
          {"named_by_papers_labels", r.named_primary},
          {"measurements", r.measurements}};
}

Json countsJson(const PrecisionCounts& p) {
  Json on = Json::object();
  for (const auto& [kind, count] : p.on) on[kind] = count;
  return {{"measurements", p.measurements},
          {"right_class", p.right_class},
          {"right_size", p.right_size},
          {"on", on}};
}

template <class Counts>
Json binsJson(const std::vector<Counts>& bins) {
  Json rows = Json::array();
  for (const Counts& bin : bins) rows.push_back(countsJson(bin));
  return rows;
}

}  // namespace

Json frontEndJson(const FrontEndEvaluation& f) {
  Json visible = Json::object(), with_points = Json::object(), labels = Json::object();
  for (std::size_t c = 0; c < f.class_names.size(); ++c) {
    visible[f.class_names[c]] = binsJson(f.visible[c]);
    with_points[f.class_names[c]] = binsJson(f.with_points[c]);
  }
  for (const auto& [label, bins] : f.labels) labels[label] = binsJson(bins);
  return {{"name", f.name},
          {"sensors", f.sensors},
          {"scans", f.scans},
          {"scans_without_truth", f.scans_without_truth},
          {"measurements", f.measurements},
          {"surroundings_known", f.surroundings},
          {"range_edges_m", f.range_edges},
          {"visible", visible},
          {"with_points", with_points},
          {"labels", labels}};
}

}  // namespace perception
