#pragma once
#include <cstddef>
#include <functional>
#include <vector>

#include "libperception/calibration/detectors/DetectorCounts.h"
#include "libperception/calibration/detectors/Intervals.h"
#include "libperception/measurement/objects/ObjectClass.h"

namespace perception {

/// Fewest samples of a share: one in twenty is 5 %.
inline constexpr std::size_t kFewestSamples = 20;

/// Which chances of a detector count.
using ChancePick = std::function<bool(const DetectorChance&)>;

/// P_D of a class with its interval, of chances that `pick` takes.
CredibleInterval detectionOf(const DetectorCounts& counts, ClassId c, const ChancePick& pick);
/// What a scan has, detections on nothing or objects that enter, with its interval.
CredibleInterval rateOf(const DetectorCounts& counts, std::size_t ClutterCount::*what);
/// Share of a label among the detections of a class, with its interval.
CredibleInterval labelOf(const DetectorCounts& counts, ClassId c, int label);
/// The errors of places and edges on road users over what is stated, [-] root mean square, with its
/// interval; without errors low is 0.
CredibleInterval noiseOf(const DetectorCounts& counts, const ClassTable& classes);

/// Chances of a class: how many there are, how many were detected, and the sum of the INI's P_D.
struct ChanceShare {
  std::size_t seen = 0, all = 0;
  double stated = 0;
};
ChanceShare shareOf(const DetectorCounts& counts, ClassId c, const ChancePick& pick);

/// Labels of the detections of a class.
struct LabelCounts {
  std::vector<std::size_t> of;  ///< by label
  std::size_t all = 0;
};
LabelCounts labelsOf(const DetectorCounts& counts, ClassId c, std::size_t labels);

}  // namespace perception
