#include "libperception/filter/state/FilterModel.h"

namespace perception {

void FilterParams::visit(ParamVisitor& v) {
  v.real("gate_probability", gate_probability, {0.5, 1 - 1e-12}, "",
         "share of true track-measurement pairs in the gate");
  v.real("survival_in_view", survival_in_view, {0.1, 1e6}, "s", "mean life of an object in view");
  v.real("survival_out_of_view", survival_out_of_view, {0.1, 1e6}, "s",
         "mean life of an object out of every view");
  v.real("existence_min", existence_min, {1e-9, 0.5}, "", "tracks below are dropped");
  v.real("existence_max", existence_max, {0.5, 1}, "", "existence after a hit");
  v.real("class_epsilon", class_epsilon, {0, 0.1}, "", "floor of a class probability");
  v.real("class_forgetting", class_forgetting, {0.1, 1e9}, "s", "time constant of the class chain");
  v.real("kinematic_exponent", kinematic_exponent, {0, 1}, "",
         "tempers innovations in the class update");
  v.real("height_exponent", height_exponent, {0, 1}, "",
         "tempers what the estimated height says of the class; 0: nothing");
  v.real("side_exponent", side_exponent, {0, 1}, "",
         "tempers what complete sides (length, width) say of the class; 0: nothing");
  v.real("speed_slack", speed_slack, {0, 10}, "",
         "share of max_speed by which faster objects are still plausible; 0: no limit");
  v.real("start_speed_sigma", start_speed_sigma, {0.1, 50}, "m/s", "speed of newborn objects");
  v.real("orient_min_speed", orient_min_speed, {0.1, 20}, "m/s",
         "motion from which a heading is taken");
  v.real("orient_max_sigma", orient_max_sigma, {0.05, 1}, "rad", "... when it is this certain");
  v.real("shape_yaw_sigma", shape_yaw_sigma, {0.01, 1}, "rad",
         "added to what a box says of the heading");
  v.real("side_sigma", side_sigma, {0.01, 5}, "m", "a seen side as a measurement of the extent");
  v.real("base_walk", base_walk, {0, 10}, "m^2/s", "random walk of the base height");
  v.real("body_heading_walk", body_heading_walk, {0, 100}, "rad^2/s",
         "random walk of where people look");
  v.real("occluded_detection", occluded_detection, {0, 1}, "",
         "share of P_D that objects keep which others hide");
  v.real("occlusion_tolerance", occlusion_tolerance, {0, 20}, "m",
         "how far behind the horizon a track still counts as visible");
  v.real("merge_area", merge_area, {0, 100}, "m^2",
         "footprints from this size on swallow tracks inside them; 0: never");
  v.choiceOf("heading", heading, {"split", "counting", "wide", "ignored"},
             "use of measured headings that may be reversed");
  v.integer("ranked_children", ranked_children, {1, 1000},
            "assignments that a hypothesis is continued with (association = ranked)");
  v.real("ranked_span", ranked_span, {0.1, 1e9}, "",
         "hypotheses lighter than the best by more in log weight are dropped (ranked)");
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
}

}  // namespace perception
