#pragma once
#include <string>
#include <vector>

#include "libperception/core/GroundTruth.h"
#include "libperception/evaluation/matching/Footprint.h"
#include "libperception/measurement/objects/ObjectClass.h"

namespace perception {

/// Criteria of counted truth objects, ego frame.
struct SelectionOptions {
  double range = 20;             ///< [m] of the center ([radecki2016]: "20m semi-circle in front")
  double fov = kPi;              ///< [rad] full opening angle of the sector ahead
  double complete_fov = kTwoPi;  ///< [rad] full angle ahead in which the truth is complete: outputs
                                 ///< outside are not false objects
  int min_points = 20;           ///< lidar returns on the object, if the truth has their number
  int max_occluded = 2;          ///< KITTI's levels; 3 = unknown
};

/// Whether a truth object counts, and if not, the first criterion it fails.
enum class TruthUse { kCounts, kOutside, kIgnored, kNoClass, kOccluded, kFewPoints };
inline constexpr int kTruthUses = 6;
const char* describe(TruthUse use);

/// Index in `class_names` of the class of a truth type, or -1: Van and Car are car, Truck and Bus
/// are bus, Person_sitting is pedestrian; any other type is the class of the same name.
/// Case-insensitive.
ClassId classOfTruth(const std::string& type, const std::vector<std::string>& class_names);

/// Type of an area or a place that the truth does not label: what stands there is neither right nor
/// false.
inline constexpr const char* kAreaType = "DontCare";
/// Case-insensitive.
bool isArea(const TruthObject& object);

TruthUse useOf(const TruthObject& object, const GroundView& view, ClassId class_id,
               const SelectionOptions& options);

}  // namespace perception
