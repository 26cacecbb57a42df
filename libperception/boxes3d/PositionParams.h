#pragma once
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/core/math/Angle.h"

namespace perception {

/// [sensor.LABEL.positions]: measurements of 3D boxes or points. Tables "key.LABEL" are per label;
/// a label without an entry has 0.
struct PositionParams {
  using Table = std::vector<std::pair<std::string, double>>;
  std::vector<std::string> labels{"object"};        ///< the columns of the class tables
  std::vector<std::string> names{"object=object"};  ///< the detector's class = one of the labels
  double min_score = -1e9;                          ///< boxes below are dropped; assumed: none
  double sigma = 0.3;               ///< [m] of the center, each axis (method.md 8.9, assumed)
  double range_share = 0;           ///< [-] share of the range added to sigma (method.md 8.9)
  double clutter_sigma_growth = 0;  ///< [-] growth of both at P(clutter) = 1 (method.md 8.9)

  /// How scores become evidence: by the figures below (fitted: those of perception-calibrate
  /// confidence, so each label that has boxes must have them), or learned while running (method.md
  /// 8.12).
  enum class Confidence { kFixed, kLearnt, kFitted };
  Confidence confidence = Confidence::kFixed;
  /// Score as evidence, method.md (52), fitted on recordings with truth: P(object | score, range) =
  /// 1 / (1 + exp(-slope (score - offset) + fade range)), [1/score], [score], [1/m]; slope 0:
  /// scores are no evidence. balance: log of (objects / clutter) in those; it converts the odds
  /// into p(score | object) / p(score | clutter).
  Table score_slope, score_offset, score_fade, score_balance;
  double score_limit = 6;  ///< bound of that logarithm (method.md (52), assumed)
  /// Classes whose boxes have the scores of clutter (method.md 8.9, assumed).
  std::vector<std::string> clutter_like{"static-other"};
  /// Weight of that logarithm for classes that the label does not name: a pedestrian that the
  /// detector also labels cyclist has a low score as cyclist (method.md 8.9, assumed).
  double off_label_score_weight = 0.5;
  /// [m] boxes of different labels closer than this are of one object, of which the most probable
  /// is used; 0: off. (On KITTI's training sequences its label is right for 96 % of pedestrians and
  /// of cyclists.)
  double group_distance = 0;

  bool sizes = false;  ///< length, width, height and direction of the box are measured, too
  double axis_sigma = radians(10);  ///< [rad] of that direction as an axis (assumed)
  double heading_flip = 0.5;        ///< share of reversed directions; 0.5: unknown (assumed)
  double length_sigma = 0.3, width_sigma = 0.3;      ///< [m] (assumed)
  double height_sigma = 0.3, base_sigma = 0.3;       ///< [m] (assumed)
  Table length_excess, width_excess, height_excess;  ///< [m] bias of the sizes of a label's boxes

  void visit(ParamVisitor& v);
  /// Indices into `labels` by the detector's class names.
  std::map<std::string, int> labelOf() const;
};

}  // namespace perception
