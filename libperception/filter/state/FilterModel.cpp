#include "libperception/filter/state/FilterModel.h"

namespace perception {

void FilterParams::visit(ParamVisitor& v) {
  v.real("existence_min", existence_min, {1e-9, 0.5}, "", "tracks below are dropped");
  v.real("class_epsilon", class_epsilon, {0, 0.1}, "", "floor of a class probability");
  v.real("class_forgetting", class_forgetting, {0.1, 1e9}, "s", "time constant of the class chain");
  v.real("side_exponent", side_exponent, {0, 1}, "",
         "tempers length and width of complete sides in the class update; 0: not used");
  v.real("fast_births", fast_births, {0, 1}, "",
         "share of new objects on wheels that may be as fast as their class can");
  v.real("occluded_detection", occluded_detection, {0, 1}, "",
         "share of P_D that occluded objects keep");
  v.real("occlusion_tolerance", occlusion_tolerance, {0, 20}, "m",
         "a track is occluded only beyond the occlusion map's range plus this");
  v.real("decide_class", decide_class, {0, 1}, "",
         "class probability from which only that class's filter is updated; 0: never");
  v.boolean("shape_prior", shape_prior,
            "associations are also scored by height and lowest point of a detection");
  v.real("region_memory", region_memory, {0, 0.99}, "",
         "correlation of a sensor's errors of one object, in the association; 0: independent");
  v.real("region_time", region_time, {0.01, 1e4}, "s", "time constant of region_memory");
  v.boolean("sampled_births", sampled_births,
            "samples birth or clutter, as in DUC; false: Bernoulli newborns (sampled only)");
  v.real(
      "existence_decay", existence_decay, {0, 1e4}, "s",
      "in which the existence of an undetected object falls to 5 %, as in DUC (3); 0: Bernoulli");
  v.real("max_distance", max_distance, {1, 1e5}, "m",
         "tracks farther from the vehicle are dropped");
  v.expert();
  v.real("gate_probability", gate_probability, {0.5, 1 - 1e-12}, "",
         "P(a true track-measurement pair passes the gate)");
  v.real("survival_in_view", survival_in_view, {0.1, 1e6}, "s", "mean life of an object in view");
  v.real("survival_out_of_view", survival_out_of_view, {0.1, 1e6}, "s",
         "mean life of an object out of view of all sensors");
  v.real("kinematic_exponent", kinematic_exponent, {0, 1}, "",
         "tempers the innovations in the class update");
  v.real("height_exponent", height_exponent, {0, 1}, "",
         "tempers the estimated height in the class update; 0: not used");
  v.real("merge_area", merge_area, {0, 100}, "m^2",
         "smallest footprint that tracks inside it are merged with; 0: no merging");
  v.integer("ranked_children", ranked_children, {1, 1000},
            "most assignments per hypothesis (association = ranked)");
  v.real("ranked_span", ranked_span, {0.1, 1e9}, "",
         "largest difference of log weight to the best hypothesis (ranked)");
}

}  // namespace perception
