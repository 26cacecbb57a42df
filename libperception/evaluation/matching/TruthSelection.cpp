#include "libperception/evaluation/matching/TruthSelection.h"

#include <algorithm>
#include <array>
#include <utility>

namespace perception {
namespace {

// Truth types (KITTI) whose class has another name (KITTI's Van counts as car; method.md 2.2: a
// truck moves like a bus).
constexpr std::array<std::pair<const char*, const char*>, 3> kClassOfType = {{
    {"van", "car"},
    {"truck", "bus"},
    {"person_sitting", "pedestrian"},
}};

std::string lowerCase(std::string text) {
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');  // ASCII only: no locale
  }
  return text;
}

}  // namespace

const char* describe(TruthUse use) {
  switch (use) {
    case TruthUse::kCounts:
      return "counted";
    case TruthUse::kOutside:
      return "outside the sector";
    case TruthUse::kIgnored:
      return "marked as to be ignored";
    case TruthUse::kNoClass:
      return "of a type that no class of the run covers";
    case TruthUse::kOccluded:
      return "too much or unknown occlusion";
    case TruthUse::kFewPoints:
      return "too few lidar points";
  }
  return "";
}

ClassId classOfTruth(const std::string& type, const std::vector<std::string>& class_names) {
  std::string name = lowerCase(type);
  for (const auto& [from, to] : kClassOfType) {
    if (name == from) name = to;
  }
  const auto found = std::find_if(class_names.begin(), class_names.end(),
                                  [&](const std::string& c) { return lowerCase(c) == name; });
  return found == class_names.end() ? -1 : static_cast<ClassId>(found - class_names.begin());
}

bool isArea(const TruthObject& object) { return lowerCase(object.type) == lowerCase(kAreaType); }

TruthUse useOf(const TruthObject& object, const GroundView& view, ClassId class_id,
               const SelectionOptions& options) {
  if (isArea(object)) return TruthUse::kIgnored;  // it may have no position (KITTI: an image area)
  if (!inSector(view, options.range, options.fov)) return TruthUse::kOutside;
  if (object.ignore) return TruthUse::kIgnored;
  if (class_id < 0) return TruthUse::kNoClass;
  if (object.occluded > options.max_occluded) return TruthUse::kOccluded;
  if (object.lidar_points >= 0 && object.lidar_points < options.min_points)
    return TruthUse::kFewPoints;
  return TruthUse::kCounts;
}

}  // namespace perception
