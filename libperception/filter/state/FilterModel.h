#pragma once
#include <memory>

#include "libperception/core/Frames.h"
#include "libperception/filter/state/Heading.h"
#include "libperception/measurement/objects/ObjectClass.h"

namespace perception {

/// Proposal distribution of the associations of a scan: [run] association.
enum class Proposal {
  kSampled,  ///< drawn measurement by measurement from the exact conditional ([radecki2016]'s
             ///< optimal proposal, method.md 5.4)
  kRanked,   ///< the likeliest assignments of every hypothesis (method.md 6)
  kNearest,  ///< the likeliest assignment of one hypothesis: global nearest neighbor, a baseline
};

/// [filter]: parameters of the recursion other than those of classes and sensors. Sources:
/// method.md 3 to 5.
struct FilterParams {
  /// P(a true track-measurement pair passes the gate) (method.md 5.2; assumed).
  double gate_probability = 0.999;
  /// [s] mean life of an object in some sensor's view (method.md 5.1; assumed).
  double survival_in_view = 60;
  /// [s] the same once it has been out of view of all sensors for a second (method.md 5.1;
  /// assumed).
  double survival_out_of_view = 6;
  /// Existence probability below which a track is dropped; must be << that of a newborn (assumed).
  double existence_min = 0.002;
  double existence_max = 0.999;  ///< existence probability after a detection (method.md 5.5)
  /// Floor of every class probability (method.md 5.6; with 1e-3 the unlikely classes of a track win
  /// stray measurements over births).
  double class_epsilon = 1e-5;
  double class_forgetting = 1000;  ///< [s] time constant of the class chain (method.md 5.7)
  /// Tempering exponent of the innovations in the class update only (method.md 5.6).
  double kinematic_exponent = 0.5;
  /// Tempering exponent of the estimated height in the class update; 0: not used (method.md 5.14).
  double height_exponent = 0.5;
  /// The same for length and width from complete sides (method.md 5.14). 0 by default, since a side
  /// of a partly occluded car may be wrongly taken as complete; 0.5 for boxes of detectors whose
  /// labels are not informative.
  double side_exponent = 0;
  /// The likelihood of a speed above the max_speed of a class falls as a Gaussian; this is its
  /// standard deviation as a share of max_speed (method.md 5.5; assumed). 0: every speed is equally
  /// likely.
  double speed_slack = 0.2;
  /// [m/s] standard deviation of the initial velocity of moving objects, limited to half of the
  /// max_speed of the class (method.md 3.4).
  double start_speed_sigma = 5;
  /// Share of newborn objects on wheels whose speed may be any up to the max_speed of the class:
  /// the rest has start_speed_sigma (method.md 3.4).
  double fast_births = 0;
  double orient_min_speed =
      1;  ///< [m/s] speed from which the velocity initializes the heading (method.md 3.4) ...
  double orient_max_sigma = 0.5;  ///< [rad] ... if its standard deviation is below this
  double shape_yaw_sigma = 0.15;  ///< [rad] noise added to the heading of a box (method.md 3.4)
  /// [m] noise of a complete side as measurement of the extent (method.md 5.13; measured on KITTI:
  /// .5).
  double side_sigma = 0.5;
  double base_walk = 0.05;  ///< [m^2/s] random walk of the base height (method.md 2.4)
  /// [rad^2/s] random walk of the body heading; twice a cyclist's rotation noise (method.md 5.1).
  double body_heading_walk = radians(30) * radians(30);
  double occluded_detection = 0;  ///< share of P_D that occluded objects keep (method.md 5.8)
  /// [m] a track is occluded only if it lies farther than this behind the range of the occlusion
  /// map (method.md 5.8; assumed).
  double occlusion_tolerance = 1.0;
  /// [m^2] least footprint of a track that absorbs the tracks whose centers lie inside it; 0: no
  /// merging (method.md 5.9).
  double merge_area = 2.0;
  HeadingMode heading = HeadingMode::kSplit;  ///< kWide: sensor set C/H (method.md 7)
  int ranked_children = 4;                    ///< most assignments per hypothesis (method.md 6)
  /// Hypotheses whose log weight is lower than the best one's by more are dropped (14: a ratio of
  /// 1e-6; method.md 6).
  double ranked_span = 14;
  /// Class probability from which the class of a track is decided: from then on only the filter of
  /// that class is updated. The filters of the other classes are restored from it when the class is
  /// no longer the likeliest, its probability falls below this value or a measurement lies outside
  /// the .99 chi-square gate of its filter [radecki2016]. 0: never.
  double decide_class = 0;
  /// Scores associations also by the height and lowest point of a detection, which are not axes of
  /// z: density given the track against those given birth and clutter (assignment prior of
  /// [radecki2016]).
  bool shape_prior = false;
  /// Correlation of a sensor's measurement errors of one object from scan to scan, in the
  /// association only (assignment prior of [radecki2016]). 0: independent errors.
  double region_memory = 0;
  double region_time = 1;  ///< [s] time constant of the decay of that correlation (assumed)
  /// Samples birth or clutter as in DUC instead of a Bernoulli newborn (method.md 5.3); with the
  /// sampled proposal only.
  bool sampled_births = false;
  /// [s] in which the existence probability of an undetected object falls to 5 %, as in DUC (3 s);
  /// 0: Bernoulli existence.
  double existence_decay = 0;
  double max_distance = 150;  ///< [m] from the vehicle; tracks beyond are dropped (method.md 5.9)

  void visit(ParamVisitor& v);
};

class LanePrior;

/// All models and parameters of the filter.
struct FilterModel {
  ClassTable classes;
  FilterParams params;
  Proposal proposal = Proposal::kSampled;
  std::shared_ptr<const LanePrior> lanes;  ///< null: no lane map
  double history =
      0;  ///< [s] of past states kept through Track::previous, for fixed-lag smoothing; 0: none
};

}  // namespace perception
