#pragma once
#include <optional>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/core/Frames.h"
#include "libperception/lidar/Hull.h"
#include "libperception/measurement/Measurement.h"

namespace perception {

/// How boxes are laid about clusters: [sensor.LABEL.boxes].
struct BoxParams {
  double step = radians(2);           ///< [rad] of the search over 90 degrees (method.md 8.2)
  double min_distance = 0.05;         ///< [m] d0 of the closeness criterion (Zhang: 0.01)
  int max_points = 400;               ///< of a cluster used in the search, evenly taken
  double straggler_share = 0.015;     ///< of the returns at each end, left out when ...
  double straggler_gap = 0.25;        ///< [m] ... that parts them from the rest (own choice)
  double corner_sigma = 0.20;         ///< [m] by which a side's end may be off (KITTI 0000)
  double yaw_sigma_min = radians(3);  ///< [rad] of the longest, clearest side
  double grazing = radians(15);       ///< [rad] a side seen at less shows no reliable length

  void visit(ParamVisitor& v);
};

/// L-shape fit by the closeness criterion (Zhang et al., IV 2017). Side a is the longer one; yaw is
/// that of a line, in
/// (-pi/2, pi/2]. `left_open`, `right_open`: nothing hides what continues beyond the outline's left
/// and right edge as seen from `sensor`. All in one frame. Empty for fewer than two distinct
/// points.
std::optional<PartialBox> fitBox(const std::vector<Vector2>& points, const Vector2& sensor,
                                 bool left_open, bool right_open, const BoxParams& params);

}  // namespace perception
