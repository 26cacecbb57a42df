#pragma once
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "libperception/evaluation/FrontEndCounts.h"
#include "libperception/evaluation/TruthAlignment.h"
#include "libperception/evaluation/TruthSelection.h"
#include "libperception/scene/MeasurementRun.h"

namespace perception {

/// How a front end's measurements are held against the truth.
struct FrontEndOptions {
  /// Of these min_points, max_occluded and complete_fov hold; range and sector are the sensor's
  /// own.
  SelectionOptions selection;
  AlignmentOptions alignment;
  double margin = 0.3;    ///< [m] a measurement so near to a footprint lies on it ...
  double deviations = 2;  ///< ... beside so many standard deviations along and across the sight
  double person_side =
      1.2;                ///< [m] longest side below which a thing is person-sized (method.md 8.2)
  double overhead = 2.0;  ///< [m] above the vehicle's ground: crowns, bridges are no object
  std::vector<double> range_edges = {0, 10, 20, 30, 50, 70, 150};  ///< [m] of the range bins
  bool center_range = false;  ///< ranges of truth by the center, not by the closest point
  /// The truth holds what stands around, too (simulated logs), so that sizes can be judged.
  bool surroundings = false;
};

/// What a label says of its object.
struct LabelMeaning {
  std::vector<std::string> classes;  ///< that it names; empty: none, any road user is right
  enum class Size { kAny, kPerson, kVehicle } size = Size::kAny;
  bool primary = true;  ///< false: not one of the labels of [radecki2016]
  bool sized = true;    ///< false: it is no statement about size (camera detectors)
};
/// car_sized, unstable, person_sized (lidar), car, person (cameras) and names of classes.
LabelMeaning meaningOf(const std::string& label, const std::vector<std::string>& class_names);

/// Recall and precision of one front end, or several that are taken together.
struct FrontEndEvaluation {
  std::string name;  ///< as asked for
  std::size_t sensors = 0, scans = 0;
  std::size_t scans_without_truth = 0;  ///< they count in nothing
  std::size_t measurements = 0;         ///< of the scans with truth, everywhere
  bool surroundings = false;
  std::vector<std::string> class_names;
  std::vector<double> range_edges;  ///< [m]
  /// By class and range bin: not hidden; of these with enough lidar points (where counted).
  std::vector<std::vector<RecallCounts>> visible, with_points;
  std::map<std::string, std::vector<PrecisionCounts>> labels;  ///< by label and range bin

  std::size_t bins() const { return range_edges.size() - 1; }
  RecallCounts recall(const std::vector<std::string>& classes, bool points) const;
  PrecisionCounts precision(const std::string& label) const;
  /// Adds another run's counts of the same front end. Throws DataError when the classes differ.
  FrontEndEvaluation& operator+=(const FrontEndEvaluation& other);
};

/// All sensors of the run whose labels match the shell pattern ("RADAR_*"), taken together. Throws
/// DataError when there is none.
FrontEndEvaluation evaluateFrontEnd(const MeasurementRun& run, const std::string& pattern,
                                    const GroundTruth& truth, const FrontEndOptions& options);

}  // namespace perception
