#pragma once
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "libperception/evaluation/front_ends/FrontEndCounts.h"
#include "libperception/evaluation/matching/TruthAlignment.h"
#include "libperception/evaluation/matching/TruthSelection.h"
#include "libperception/scene/files/MeasurementRun.h"

namespace perception {

/// Parameters of the evaluation of a front end's measurements against the truth.
struct FrontEndOptions {
  /// min_points, max_occluded and complete_fov are used; range and field of view are the sensor's.
  SelectionOptions selection;
  AlignmentOptions alignment;
  double margin = 0.3;  ///< [m] a measurement within this distance of a footprint lies on it ...
  double deviations =
      2;  ///< ... plus this many of its standard deviations along and across the line of sight
  double person_side = 1.2;  ///< [m] longest side of a person-sized object (method.md 8.2)
  double overhead = 2.0;     ///< [m] truth objects whose base is higher above the ego's ground are
                             ///< ignored (tree crowns, bridges)
  std::vector<double> range_edges = {0, 10, 20, 30, 50, 70, 150};  ///< [m] of the range bins
  bool center_range = false;  ///< bin truth by the range of the center instead of the closest point
  /// The truth also holds static surroundings (simulated logs), so that size precision is defined.
  bool surroundings = false;
};

/// Interpretation of a front end's label.
struct LabelMeaning {
  std::vector<std::string>
      classes;  ///< classes that it stands for; empty: any road user is correct
  enum class Size { kAny, kPerson, kVehicle } size = Size::kAny;
  bool primary = true;  ///< a label that [radecki2016] has, too
  bool sized = true;    ///< false: it does not state a size (camera detectors)
};
/// car_sized, unstable, person_sized (lidar), car, person (cameras) and names of classes.
LabelMeaning meaningOf(const std::string& label, const std::vector<std::string>& class_names);

/// Recall and precision of one front end, or pooled over several.
struct FrontEndEvaluation {
  std::string name;  ///< label or pattern
  std::size_t sensors = 0, scans = 0;
  std::size_t scans_without_truth = 0;  ///< not counted
  std::size_t measurements = 0;         ///< of the scans with truth, everywhere
  bool surroundings = false;
  std::vector<std::string> class_names;
  std::vector<double> range_edges;  ///< [m]
  /// By class and range bin: unoccluded objects; of these those with enough lidar points (where
  /// counted).
  std::vector<std::vector<RecallCounts>> visible, with_points;
  std::map<std::string, std::vector<PrecisionCounts>> labels;  ///< by label and range bin

  std::size_t bins() const { return range_edges.size() - 1; }
  RecallCounts recall(const std::vector<std::string>& classes, bool points) const;
  PrecisionCounts precision(const std::string& label) const;
  /// Adds another run's counts of the same front end. Throws DataError when the classes differ.
  FrontEndEvaluation& operator+=(const FrontEndEvaluation& other);
};

/// Pools all sensors of the run whose labels match the shell pattern ("RADAR_*"). Throws DataError
/// when there is none.
FrontEndEvaluation evaluateFrontEnd(const MeasurementRun& run, const std::string& pattern,
                                    const GroundTruth& truth, const FrontEndOptions& options);

}  // namespace perception
