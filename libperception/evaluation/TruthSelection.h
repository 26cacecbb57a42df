#pragma once
#include <string>
#include <vector>

#include "libperception/core/GroundTruth.h"
#include "libperception/evaluation/Footprint.h"
#include "libperception/measurement/ObjectClass.h"

namespace perception {

/// Which truth objects count, ego frame.
struct SelectionOptions {
  double range = 20;  ///< [m] of the center ([radecki2016]: "20m semi-circle in front")
  double fov = kPi;   ///< [rad] whole opening angle of the sector ahead
  double complete_fov =
      kTwoPi;            ///< [rad] beyond it the truth lacks objects: no output there is false
  int min_points = 20;   ///< lidar returns on the object, where the truth counts them
  int max_occluded = 2;  ///< KITTI: 3 = unknown
};

/// Why a truth object counts or not; the first reason that holds.
enum class TruthUse { kCounts, kOutside, kIgnored, kNoClass, kOccluded, kFewPoints };
inline constexpr int kTruthUses = 6;
const char* describe(TruthUse use);

/// The class of that name among `class_names` that stands for a truth type or -1: Van and Car are
/// car, Truck and Bus are bus, Person_sitting is a pedestrian; other types stand for the class of
/// their own name. Case does not matter.
ClassId classOfTruth(const std::string& type, const std::vector<std::string>& class_names);

/// DontCare: an area of which nothing is known.
bool isArea(const TruthObject& object);

TruthUse useOf(const TruthObject& object, const GroundView& view, ClassId class_id,
               const SelectionOptions& options);

}  // namespace perception
