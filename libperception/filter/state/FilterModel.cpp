#include "libperception/filter/state/FilterModel.h"

namespace perception {

void FilterParams::visit(ParamVisitor& v) {
  v.real("existence_min", existence_min, {1e-9, 0.5}, "", "tracks below are dropped");
  v.real("class_epsilon", class_epsilon, {0, 0.1}, "", "floor of a class probability");
  v.real("class_forgetting", class_forgetting, {0.1, 1e9}, "s", "time constant of the class chain");
  v.real("side_exponent", side_exponent, {0, 1}, "",
         "tempers what complete sides (length, width) say of the class; 0: nothing");
  v.real("occluded_detection", occluded_detection, {0, 1}, "",
         "share of P_D that objects keep which others hide");
  v.real("occlusion_tolerance", occlusion_tolerance, {0, 20}, "m",
         "how far behind the horizon a track still counts as visible");
  v.real("decide_class", decide_class, {0, 1}, "",
         "class probability from which its filter alone goes on until surprised; 0: never");
  v.boolean("shape_prior", shape_prior,
            "associations weigh the height and lowest point of a detection, too");
  v.real("region_memory", region_memory, {0, 0.99}, "",
         "correlation of a sensor's errors of one object, for the association; 0: independent");
  v.real("region_time", region_time, {0.01, 1e4}, "s", "in which it falls to 1/e");
  v.boolean("sampled_births", sampled_births,
            "birth or clutter is drawn, as in DUC; else a newborn may be either (sampled only)");
  v.real("existence_decay", existence_decay, {0, 1e4}, "s",
         "in which an unseen object's existence falls to 5 %, as in DUC (3); 0: by detections");
  v.real("max_distance", max_distance, {1, 1e5}, "m",
         "tracks farther from the vehicle are dropped");
  v.expert();
  v.real("gate_probability", gate_probability, {0.5, 1 - 1e-12}, "",
         "share of true track-measurement pairs in the gate");
  v.real("survival_in_view", survival_in_view, {0.1, 1e6}, "s", "mean life of an object in view");
  v.real("survival_out_of_view", survival_out_of_view, {0.1, 1e6}, "s",
         "mean life of an object out of every view");
  v.real("kinematic_exponent", kinematic_exponent, {0, 1}, "",
         "tempers innovations in the class update");
  v.real("height_exponent", height_exponent, {0, 1}, "",
         "tempers what the estimated height says of the class; 0: nothing");
  v.real("merge_area", merge_area, {0, 100}, "m^2",
         "footprints from this size on absorb tracks inside them; 0: never");
  v.integer("ranked_children", ranked_children, {1, 1000},
            "assignments that a hypothesis is continued with (association = ranked)");
  v.real("ranked_span", ranked_span, {0.1, 1e9}, "",
         "hypotheses lighter than the best by more in log weight are dropped (ranked)");
}

}  // namespace perception
