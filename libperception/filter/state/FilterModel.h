#pragma once
#include <memory>

#include "libperception/core/Frames.h"
#include "libperception/filter/state/Heading.h"
#include "libperception/measurement/ObjectClass.h"

namespace perception {

/// How a hypothesis chooses the causes of a scan's measurements. [run] association.
enum class Proposal {
  kSampled,  ///< drawn measurement by measurement from the exact conditional ([radecki2016]'s
             ///< optimal proposal, method.md 5.4)
  kRanked,   ///< the likeliest assignments of every hypothesis (method.md 6)
  kNearest,  ///< the likeliest assignment of one hypothesis: global nearest neighbor, a baseline
};

/// [filter]: everything of the recursion that is not a property of a class or a sensor. Sources:
/// method.md 3 to 5.
struct FilterParams {
  /// Share of true pairs that pass the gate (method.md 5.2; assumed).
  double gate_probability = 0.999;
  /// [s] mean life of an object in some sensor's view (method.md 5.1; assumed).
  double survival_in_view = 60;
  /// [s] the same when no sensor could have seen it for a second (method.md 5.1; assumed).
  double survival_out_of_view = 6;
  /// Below it a track is dropped; must be << the existence of a newborn (assumed).
  double existence_min = 0.002;
  double existence_max = 0.999;  ///< existence after a hit (method.md 5.5)
  /// Floor of every class probability (method.md 5.6; at 1e-3 a track's unlikely class would then
  /// win stray measurements over births).
  double class_epsilon = 1e-5;
  double class_forgetting = 1000;  ///< [s] time constant of the class chain (method.md 5.7)
  /// Tempers the innovations' evidence in the class update only (method.md 5.6).
  double kinematic_exponent = 0.5;
  /// Tempers what the estimated height says of the class; 0: nothing (method.md 5.14).
  double height_exponent = 0.5;
  /// The same of the length and width of complete sides (method.md 5.14). Off: a half-hidden car's
  /// complete side may be half a side; 0.5 for boxes of detectors whose labels tell little.
  double side_exponent = 0;
  /// Share of a class's max_speed by which faster objects are plausible; 0: no limit (assumed).
  double speed_slack = 0.2;
  /// [m/s] of newborn moving objects, at most half of the class's max_speed (method.md 3.4).
  double start_speed_sigma = 5;
  double orient_min_speed = 1;    ///< [m/s] from which motion gives a heading (method.md 3.4) ...
  double orient_max_sigma = 0.5;  ///< [rad] ... when the heading would be this certain
  double shape_yaw_sigma = 0.15;  ///< [rad] added to what a box says of the heading (method.md 3.4)
  /// [m] of a seen side as a measurement of the extent (method.md 5.13; measured on KITTI: .5).
  double side_sigma = 0.5;
  double base_walk = 0.05;  ///< [m^2/s] random walk of the base height (method.md 2.4)
  /// [rad^2/s] random walk of where people look; twice a cyclist's rotation noise (method.md 5.1).
  double body_heading_walk = radians(30) * radians(30);
  double occluded_detection = 0;  ///< share of P_D that hidden objects keep (method.md 5.8)
  /// [m] a track this much behind the horizon is still visible (method.md 5.8; assumed).
  double occlusion_tolerance = 1.0;
  /// [m^2] footprints from this size on absorb tracks inside them (method.md 5.9); 0: never.
  double merge_area = 2.0;
  HeadingMode heading = HeadingMode::kSplit;  ///< kWide: the camera is C/H (method.md 7)
  int ranked_children = 4;  ///< assignments that a hypothesis is continued with (method.md 6)
  /// In log weight below the best; lighter hypotheses (1e-6) are dropped (method.md 6).
  double ranked_span = 14;
  /// Probability from which a class is decided, and its filter alone goes on; below it, or when a
  /// measurement surprises that filter (one in a hundred), the bank widens again [radecki2016]. 0:
  /// never.
  double decide_class = 0;
  /// An association also weighs the height and the lowest point of a detection, which are no axes
  /// of the measurement: densities of the object's own against those of births and of clutter
  /// (assignment prior of [radecki2016]).
  bool shape_prior = false;
  /// Correlation of a sensor's errors of one object from scan to scan, for the association alone: a
  /// measurement is expected where the object's last region was (assignment prior of
  /// [radecki2016]). 0: errors are independent.
  double region_memory = 0;
  double region_time = 1;  ///< [s] in which that correlation falls to 1/e (assumed)
  /// Birth or clutter is drawn as in DUC instead of a Bernoulli newborn (method.md 5.3); only with
  /// the sampled proposal.
  bool sampled_births = false;
  /// [s] in which an unseen object's existence falls to 5 %, as in DUC (3 s); 0: Bernoulli.
  double existence_decay = 0;
  double max_distance = 150;  ///< [m] from the vehicle; tracks beyond are dropped (method.md 5.9)

  void visit(ParamVisitor& v);
};

class LanePrior;

/// The model of the world that the filter assumes.
struct FilterModel {
  ClassTable classes;
  FilterParams params;
  Proposal proposal = Proposal::kSampled;
  std::shared_ptr<const LanePrior> lanes;  ///< null: no map of lanes
  double history =
      0;  ///< [s] for which tracks stay linked to what they were: for smoothing; 0: not
};

}  // namespace perception
